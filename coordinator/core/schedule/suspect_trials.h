// Finds out what kills workers: notes what workers that vanish had in hand, keeps suspects from all workers
// but one at a time, and fails the jobs of what has killed as many as it takes. The rules are in
// loss_book.h. Owned by the scheduler.
#pragma once

#include <optional>
#include <string>

#include "coordinator/core/schedule/failure_handling.h"
#include "coordinator/core/schedule/scene_locality.h"

namespace tessera {

class SuspectTrials {
 public:
  SuspectTrials(ScheduleState& state, FailureHandling& failures) : state_(state), failures_(failures) {}

  // The worker vanished without a goodbye; call it while it still holds its leases.
  void Lose(Instant now, const WorkerRecord& worker, bool is_silent);
  // Fails the jobs of killers, and lets workers try suspects whose rest is over.
  void Advance(Instant now);
  // Keeps what became suspect from workers, and gives back what is no longer.
  void Mark();

  // What the worker is to try, with nothing else in hand. A frame without a `tile`: any unit of it.
  struct Trial {
    FrameChoice choice;
    std::optional<uint32_t> tile;
    // Whether the worker may get units of this tile now.
    bool Allows(WorkerId worker, uint32_t unit_tile) const {
      return (!tile || unit_tile == *tile) && !choice.frame->failures.HasFailed(worker, unit_tile);
    }
  };
  std::optional<Trial> TrialOf(Instant now, const WorkerRecord& worker);
  // What of the job is given to one worker at a time, and why; empty if nothing is.
  std::string WhyOnTrial(const Job& job) const;

 private:
  std::optional<Trial> Find(const Suspect& what, const WorkerRecord& worker) const;
  std::optional<Trial> FindIn(Job& job, uint32_t index, const Suspect& what,
                              const WorkerRecord& worker) const;
  bool IsWanted(const Suspect& what) const;
  bool IsRunnable(const Suspect& what) const;
  bool MayOthersTry(const Suspect& what, const std::set<Party>& parties) const;
  bool IsLeftToOthers(const Suspect& what, const WorkerRecord& worker) const;
  void StopLoading(const Digest& scene);

  ScheduleState& state_;
  FailureHandling& failures_;
};

}  // namespace tessera
