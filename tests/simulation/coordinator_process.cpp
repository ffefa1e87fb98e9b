#include "tests/simulation/coordinator_process.h"

#include <fmt/format.h>

#include <algorithm>

namespace tessera {
namespace {

constexpr Instant kSyncRetry = milliseconds(1000);  // as the coordinator's

}  // namespace

void CoordinatorProcess::AwaitDirective(CallId call, std::function<void(const WorkerDirective&)> answer) {
  directive_calls_[call] = std::move(answer);
}

void CoordinatorProcess::AwaitResults(CallId call, std::vector<WorkUnit> units,
                                      std::function<void(const FarmOutput::Results&)> answer) {
  results_calls_[call] = {std::move(units), std::move(answer)};
}

void CoordinatorProcess::Start() {
  uint32_t epoch = 1;
  FarmId id;
  std::vector<Fact> facts;
  for (const std::string& bytes : journal().facts()) {
    auto fact = DecodeFact(bytes);
    if (!fact) return world_.Violation("a fact cannot be read back");
    if (const auto* started = std::get_if<CoordinatorStarted>(&*fact)) {
      epoch = started->epoch + 1;
      id = started->farm;
    }
    facts.push_back(std::move(*fact));
  }
  clock_ = world_.random.Duration(0, 1e6);  // another boot, another origin
  if (id == FarmId{}) id = {world_.random.Next(), world_.random.Next()};
  const SchedulerOptions options{epoch, kAttemptsMaxDefault, Hash(++sessions_, id.low)};
  farm_ = std::make_unique<Farm>(options, kKeptBytesMaxDefault, id);
  for (const Fact& fact : facts) farm_->Restore(fact);
  RestoreSpool();
  farm_->Begin(now(), std::chrono::duration_cast<milliseconds>(world_.queue.now()));
  world_.Trace(fmt::format("start epoch={} facts={}", epoch, facts.size()));
  Check([&](Checker& checker) { checker.OnRestart(*farm_, now()); });
  for (const Fact& fact : facts) NoteFact(fact);
  Touch();
}

void CoordinatorProcess::RestoreSpool() {
  for (const FrameId frame : spool().Frames()) {
    switch (farm_->FoundInSpool(frame, spool().HasBegun(frame))) {
      case SpoolUse::kDrop: spool().Drop(frame); break;
      case SpoolUse::kKeep: break;
      case SpoolUse::kRestore:
        for (TileNode& node : spool().Nodes(frame)) farm_->RestoreNode(frame, std::move(node));
    }
  }
}

void CoordinatorProcess::Crash() {
  if (!farm_) return;
  world_.Trace("crash");
  ++world_.report.crashes;
  journal().Crash(world_.random);
  spool().Crash(world_.random);
  crash_point_ = CrashPoint::kNone;
  farm_.reset();
  unsynced_.clear();
  frees_space_ = false;
  directive_calls_.clear();
  results_calls_.clear();
  after_sync_.clear();
  world_.queue.After(world_.random.Duration(0, 3), [this] { Start(); });
}

bool CoordinatorProcess::CrashesAt(CrashPoint point) {
  if (crash_point_ != point) return false;
  Crash();
  return true;
}

// All events of a moment are applied together a moment later.
void CoordinatorProcess::PlanStep(Instant delay) {
  const Instant at = world_.queue.now() + delay;
  if (step_at_ <= at) return;
  step_at_ = at;
  world_.queue.After(delay, [this, plan = ++step_planned_] {
    if (plan == step_planned_) Step();
  });
}

void CoordinatorProcess::Step() {
  step_at_ = Instant::max();
  if (!farm_) return;
  farm_->Advance(now());
  FarmOutput& output = unsynced_.emplace_back(farm_->TakeOutput());
  for (auto& [frame, node] : std::exchange(output.accepted, {})) spool().Append(frame, std::move(node));
  for (const Fact& fact : output.facts) {
    journal().Append(fact);
    frees_space_ = frees_space_ || FreesSpace(fact);
  }
  NoteLeases(output);
  for (const std::string& line : output.log) world_.Trace(line);
  if (CrashesAt(CrashPoint::kBeforeSync)) return;
  const auto synced = Sync();
  const bool frees_space = std::exchange(frees_space_, false);
  if (!synced && frees_space) SyncFacts();
  if (!farm_) return;
  PlanStep(std::max(synced ? farm_->Patience(now()) : kSyncRetry, Instant(1000)));
  if (!synced) return;
  for (FarmOutput& each : std::exchange(unsynced_, {})) Answer(std::move(each));
  for (const auto& answer : std::exchange(after_sync_, {})) answer();
  if (journal().IsLarge()) (void)journal().Replace(farm_->Snapshot());
}

Result<void> CoordinatorProcess::Sync() {
  for (const FrameId frame : spool().Grown()) {
    if (auto nodes = farm_->Sums(frame)) spool().Replace(frame, std::move(*nodes));
  }
  auto synced = spool().Sync();
  if (synced && CrashesAt(CrashPoint::kBetweenSpoolAndJournal)) return {};
  if (synced) synced = journal().Sync();
  if (CrashesAt(CrashPoint::kBeforeAnswers)) return {};
  farm_->StorageDelayed(synced ? "" : synced.error().message);
  return synced;
}

// The end of a job is written to the reserve of the journal, ahead of the results that cannot be written.
void CoordinatorProcess::SyncFacts() {
  if (!journal().Sync(Room::kReserve)) return world_.Violation("the end of a job is not written");
  ++world_.report.ends_on_full_disk;
  if (CrashesAt(CrashPoint::kBetweenSpoolAndJournal)) return;
  for (const FarmOutput& output : unsynced_) {
    for (const FrameId frame : output.dropped) spool().Drop(frame);
  }
}

void CoordinatorProcess::Answer(FarmOutput output) {
  for (const Fact& fact : output.facts) {
    world_.Trace("fact " + Sha256(EncodeFact(fact)).Hex().substr(0, 16));
    NoteFact(fact);
  }
  for (const auto& answer : output.results) AnswerResults(answer);
  for (const auto& answer : output.directives) {
    if (auto call = directive_calls_.extract(answer.call)) call.mapped()(answer.directive);
  }
  for (const FinishedPicture& finished : output.pictures) {
    world_.Trace(fmt::format("picture job={} frame={}", Number(finished.job), finished.frame));
    Check([&](Checker& checker) { checker.OnPicture(finished); });
    WritePicture(finished.job, finished.frame);
  }
  for (auto& [frame, nodes] : output.sums) spool().Replace(frame, std::move(nodes));
  for (const FrameId frame : output.dropped) spool().Drop(frame);
  for (const FrameId frame : output.loads) Load(frame);
}

void CoordinatorProcess::Load(FrameId frame) {
  spool().Load(frame, [&](Result<std::vector<TileNode>> nodes) {
    const auto shared = std::make_shared<Result<std::vector<TileNode>>>(std::move(nodes));
    world_.queue.After(world_.random.Duration(0, 0.2), [=, this, process = world_.report.crashes] {
      if (!farm_ || world_.report.crashes != process) return;
      farm_->SumsLoaded(now(), frame, std::move(*shared));
      Touch();
    });
  });
}

void CoordinatorProcess::AnswerResults(const FarmOutput::Results& answer) {
  auto call = results_calls_.extract(answer.call);
  if (!call) return;
  const ResultsCall& waiting = call.mapped();
  for (size_t i = 0; i < waiting.units.size(); ++i) {
    const Verdict verdict = answer.verdicts[i];
    if (verdict == Verdict::kAccepted || verdict == Verdict::kDuplicate)
      Check([&](Checker& checker) { checker.OnAcknowledged(waiting.units[i]); });
    world_.report.refused += verdict == Verdict::kRefused;
    world_.report.duplicates += verdict == Verdict::kDuplicate;
    ++world_.report.results;
  }
  waiting.answer(answer);
}

// Takes a moment.
void CoordinatorProcess::WritePicture(JobId job, uint32_t frame) {
  world_.queue.After(world_.random.Duration(0, 0.2), [=, this, process = world_.report.crashes] {
    if (!farm_ || world_.report.crashes != process) return;
    if (is_disk_full_) {
      farm_->PictureDelayed(now(), {job, frame}, "no space left on device");
    } else {
      const std::string file = fmt::format("{} {}", Number(job), frame);
      farm_->PictureWritten(now(), {job, frame}, {Sha256(file), file.size()});
    }
    Touch();
  });
}

// What is on stable storage may be told to anybody and must stay true.
void CoordinatorProcess::NoteFact(const Fact& fact) {
  if (const auto* submitted = std::get_if<JobSubmitted>(&fact)) {
    world_.jobs[submitted->spec->submission - 1].id = submitted->job;
  } else if (const auto* ordered = std::get_if<JobOrdered>(&fact)) {
    world_.jobs[ordered->order->submission - 1].id = ordered->job;
  } else if (const auto* ended = std::get_if<JobEnded>(&fact)) {
    world_.ModelOf(ended->job)->told = ended->state;
  }
  Check([&](Checker& checker) { checker.OnFact(fact); });
}

void CoordinatorProcess::NoteLeases(const FarmOutput& output) {
  const auto note = [&](const std::vector<Lease>& leases) {
    for (const Lease& lease : leases) {
      if (!leases_seen_.insert(lease.id).second) continue;
      world_.Trace(fmt::format("lease {} {}", lease.id.number, lease.unit.Text()));
      Check([&](Checker& checker) { checker.OnLease(*farm_, now(), lease); });
    }
  };
  for (const auto& each : output.directives) note(each.directive.leases);
  for (const auto& each : output.results) note(each.grants.leases);
}

void CoordinatorProcess::SetDiskFull(bool is_full) {
  is_disk_full_ = is_full;
  for (Directory& each : directories_) {
    each.contents.journal.set_full(is_full);
    each.contents.spool.set_full(is_full);
  }
}

void CoordinatorProcess::SwapDirectory() {
  Crash();
  world_.directory = 1 - world_.directory;
  world_.Trace(fmt::format("directory {}", world_.directory));
}

void CoordinatorProcess::BackUp() {
  auto backup = std::make_unique<Contents>(directory().contents);
  backup->journal.Crash(world_.random);
  backup->spool.Crash(world_.random);
  directory().backup = std::move(backup);
}

bool CoordinatorProcess::RestoreBackup() {
  if (directory().backup == nullptr) return false;
  Crash();
  directory().contents = *directory().backup;
  SetDiskFull(is_disk_full_);
  ++world_.restored;
  world_.Trace(fmt::format("restored directory={}", world_.directory));
  Check([&](Checker& checker) { checker.OnRestored(); });
  return true;
}

void CoordinatorProcess::Cut(CallId call) {
  world_.queue.After(world_.random.Duration(0, 0.1), [this, call] {
    if (!farm_ || directive_calls_.erase(call) == 0) return;
    world_.Trace(fmt::format("cut call={}", static_cast<uint64_t>(call)));
    farm_->Cut(now(), call);
    Touch();
  });
}

void CoordinatorProcess::CheckEnd() {
  Check([&](Checker& checker) { checker.OnEnd(farm_.get(), now()); });
}

}  // namespace tessera
