// Results of workers: checks each against the work that is open, counts it once and merges it. Owned by the
// farm.
#pragma once

#include <optional>
#include <string>

#include "coordinator/core/frame_completion.h"

namespace tessera {

class ResultAcceptance {
 public:
  ResultAcceptance(FarmState& state, FrameCompletion& frames) : state_(state), frames_(frames) {}

  // `reason` is set if the result is refused.
  Verdict Accept(Instant now, WorkerId worker, ReturnedUnit& returned, std::string& reason);
  // Writes down how many merged units of open jobs are from workers that are not trusted any more.
  void NoteSuspects();

 private:
  Verdict Decide(Instant now, WorkerId worker, Job& job, ReturnedUnit& returned, std::string& reason);
  static bool HasForm(const Job& job, const ReturnedUnit& returned);
  std::string Mismatch(const Job& job, const ReturnedUnit& returned) const;
  std::optional<Verdict> Verify(Instant now, Job& job, WorkerId worker, const ReturnedUnit& returned);
  void Merge(Job& job, const WorkUnit& unit, RadianceTile tile);
  void CountUnmerged(Verdict verdict, const ReturnedUnit& returned, Job* job);

  FarmState& state_;
  FrameCompletion& frames_;
};

UnitsCounted CountsOf(const Job& job);

}  // namespace tessera
