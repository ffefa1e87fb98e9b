// From the facts and the spool of former processes to the farm as it was, and back to facts. Owned by the
// farm.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "coordinator/core/frame_completion.h"
#include "coordinator/core/job_extension.h"

namespace tessera {

// What to do with a frame that is found in the spool.
enum class SpoolUse {
  kDrop,
  kKeep,
  kRestore  // hand all its nodes to RestoreNode
};

class FarmRecovery {
 public:
  FarmRecovery(FarmState& state, JobEnd& end, FrameCompletion& frames, JobExtension& extension)
      : state_(state), end_(end), frames_(frames), extension_(extension) {}

  // ---- In this order: all facts, what is in the spool, Begin ----
  void Restore(const Fact& fact);
  // `begun`: results of the frame came in since its last base.
  SpoolUse FoundInSpool(FrameId frame, bool begun);
  void RestoreNode(FrameId frame, TileNode node);
  void Begin(Instant now);

  // Facts that lead to the present state: they may take the place of all before.
  std::vector<Fact> Snapshot() const;

 private:
  using Votes = std::map<WorkUnit, std::vector<Vote>>;  // of units that are not decided

  void RestoreFrame(Job& job, const FrameFinished& fact);
  void RestoreFrame(Job& job, const FrameFailed& fact);
  // Nothing more of the frame is rendered.
  void EndFrame(Job& job, uint32_t frame);
  void RestoreVote(Job& job, const VoteRecorded& fact);
  void RestoreKeptSums();
  void RestoreCounts(Job& job);
  void RestoreTimes(Instant now, Job& job) const;
  void Resume(Instant now, Job& job);
  void ResumeFrame(Job& job, uint32_t frame, const Merger& merger);
  void AppendHistory(const Job& job, std::vector<Fact>& facts) const;
  static void AppendControl(const Job& job, std::vector<Fact>& facts);

  FarmState& state_;
  JobEnd& end_;
  FrameCompletion& frames_;
  JobExtension& extension_;
  // Until Begin.
  std::map<JobId, JobOwner> owners_;  // of jobs that are not submitted yet
  std::map<JobId, JobTimed> times_;
  std::vector<WorkerBlock> blocks_;
  std::map<JobId, Votes> votes_;
  std::vector<FrameId> finished_;  // in the order they were
  std::set<FrameId> found_kept_;   // in the spool
};

WorkerQuarantined FactOf(const WorkerBlock& block);

}  // namespace tessera
