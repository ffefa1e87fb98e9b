// The coordinator of a simulation: the real farm on a simulated disk, as the core thread of the coordinator
// drives it: apply a batch of events, keep, sync, answer. Its process may crash at any point of that and
// start again.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "coordinator/core/farm.h"
#include "tests/simulation/checker.h"
#include "tests/simulation/simulated_journal.h"
#include "tests/simulation/simulated_spool.h"
#include "tests/simulation/world.h"

namespace tessera {

class CoordinatorProcess {
 public:
  explicit CoordinatorProcess(World& world) : world_(world), checkers_(MakeCheckers(world)) {}

  // nullptr while no process runs. Whoever calls it calls Touch afterwards.
  Farm* farm() { return farm_.get(); }
  Instant now() const { return world_.queue.now() + clock_; }
  // The farm has events to apply.
  void Touch() { PlanStep(world_.random.Duration(0, 0.002)); }
  CallId NextCall() { return CallId{call_next_++}; }

  // ---- Answers; lost if the process crashes before ----
  void AwaitDirective(CallId call, std::function<void(const WorkerDirective&)> answer);
  void AwaitResults(CallId call, std::vector<WorkUnit> units,
                    std::function<void(const FarmOutput::Results&)> answer);
  void AfterSync(std::function<void()> answer) { after_sync_.push_back(std::move(answer)); }

  void Start();
  // After which step of a batch the process crashes.
  enum class CrashPoint { kNone, kBeforeSync, kBetweenSpoolAndJournal, kBeforeAnswers };
  void CrashAt(CrashPoint point) { crash_point_ = point; }
  void Crash();
  void SetDiskFull(bool is_full);
  // The process crashes, and the next runs on another data directory: the one that is not in use.
  void SwapDirectory();
  // Keeps a copy of the directory in use as it is on stable storage.
  void BackUp();
  // The process crashes, and the next finds the directory as it was backed up. Returns false if there is no
  // backup.
  bool RestoreBackup();
  void AdvanceClock(Instant jump) { clock_ += jump; }
  // The farm learns that the other end of a waiting call is gone.
  void Cut(CallId call);
  void CheckEnd();

 private:
  struct ResultsCall {
    std::vector<WorkUnit> units;
    std::function<void(const FarmOutput::Results&)> answer;
  };
  void RestoreSpool();
  void PlanStep(Instant delay);
  void Step();
  // What a data directory holds.
  struct Contents {
    SimulatedJournal journal;
    SimulatedSpool spool;
  };
  struct Directory {
    Contents contents;
    std::unique_ptr<Contents> backup;
  };
  Directory& directory() { return directories_[world_.directory]; }
  SimulatedJournal& journal() { return directory().contents.journal; }
  SimulatedSpool& spool() { return directory().contents.spool; }
  Result<void> Sync();
  void SyncFacts();
  bool CrashesAt(CrashPoint point);
  void Answer(FarmOutput output);
  void AnswerResults(const FarmOutput::Results& answer);
  void Load(FrameId frame);
  void WritePicture(JobId job, uint32_t frame);
  void NoteFact(const Fact& fact);
  void NoteLeases(const FarmOutput& output);
  template <typename Call>
  void Check(const Call& call) {
    for (const auto& checker : checkers_) call(*checker);
  }

  World& world_;
  std::vector<std::unique_ptr<Checker>> checkers_;
  std::unique_ptr<Farm> farm_;
  std::array<Directory, 2> directories_;
  bool is_disk_full_ = false;
  Instant clock_{};  // ahead of simulated time; each process has its own origin
  CrashPoint crash_point_ = CrashPoint::kNone;
  uint64_t step_planned_ = 0;
  Instant step_at_ = Instant::max();
  uint64_t call_next_ = 1;
  std::vector<FarmOutput> unsynced_;
  bool frees_space_ = false;  // a fact since the last attempt to sync does
  std::map<CallId, std::function<void(const WorkerDirective&)>> directive_calls_;
  std::map<CallId, ResultsCall> results_calls_;
  std::vector<std::function<void()>> after_sync_;
  std::set<LeaseId> leases_seen_;
  uint64_t sessions_ = 0;
};

}  // namespace tessera
