#include "tests/simulation/simulation.h"

#include <fmt/format.h>

#include <algorithm>

namespace tessera {
namespace {

constexpr double kHealedLimit_s = 400;  // simulated seconds in which a healed farm must end every job
constexpr Instant kSyncRetry = milliseconds(1000);  // as the coordinator's
constexpr Instant kPictureRetry = milliseconds(2000);

}  // namespace

Simulation::Simulation(uint64_t seed, SimulationOptions options, OnTrace on_trace)
    : options_(options), on_trace_(std::move(on_trace)), random_(Hash(seed, 1)) {}

void Simulation::Trace(const std::string& line) {
  const std::string timed = fmt::format("{:.6f} {}\n", Seconds(queue_.now()), line);
  trace_.Add(timed);
  if (on_trace_) on_trace_(timed);
}

void Simulation::StartFarm() {
  uint32_t epoch = 1;
  std::vector<Fact> facts;
  for (const std::string& bytes : journal_.facts()) {
    auto fact = DecodeFact(bytes);
    if (!fact) return Violation("a fact cannot be read back");
    if (const auto* started = std::get_if<CoordinatorStarted>(&*fact)) epoch = started->epoch + 1;
    facts.push_back(std::move(*fact));
  }
  farm_clock_ = random_.Duration(0, 1e6);  // another boot, another origin
  farm_ = std::make_unique<Farm>(SchedulerOptions{epoch});
  for (const Fact& fact : facts) farm_->Restore(fact);
  RestoreSpool();
  farm_->Begin(FarmNow());
  Trace(fmt::format("start epoch={} facts={}", epoch, facts.size()));
  CheckMemory();
  for (const Fact& fact : facts) NoteFact(fact);
  Touch();
}

void Simulation::RestoreSpool() {
  for (const FrameId frame : spool_.Frames()) {
    switch (farm_->FoundInSpool(frame, spool_.HasBegun(frame))) {
      case Farm::SpoolUse::kDrop: spool_.Drop(frame); break;
      case Farm::SpoolUse::kKeep: break;
      case Farm::SpoolUse::kRestore:
        for (TileNode& node : spool_.Nodes(frame)) farm_->RestoreNode(frame, std::move(node));
    }
  }
}

void Simulation::CrashFarm() {
  if (!farm_) return;
  Trace("crash");
  ++report_.crashes;
  journal_.Crash(random_);
  spool_.Crash(random_);
  crash_point_ = 0;
  farm_.reset();
  unsynced_.clear();
  directive_calls_.clear();
  results_calls_.clear();
  after_sync_.clear();
  queue_.After(random_.Duration(0, 3), [this] { StartFarm(); });
}

// A batch of events is applied a moment later, all at once.
void Simulation::Touch() {
  PlanStep(random_.Duration(0, 0.002));
}

void Simulation::PlanStep(Instant delay) {
  const Instant at = queue_.now() + delay;
  if (step_at_ <= at) return;
  step_at_ = at;
  queue_.After(delay, [this, plan = ++step_planned_] {
    if (plan == step_planned_) Step();
  });
}

// As the coordinator's core thread: apply, keep, sync, answer.
void Simulation::Step() {
  step_at_ = Instant::max();
  if (!farm_) return;
  farm_->Advance(FarmNow());
  FarmOutput& output = unsynced_.emplace_back(farm_->TakeOutput());
  for (auto& [frame, node] : std::exchange(output.accepted, {})) spool_.Append(frame, std::move(node));
  for (const Fact& fact : output.facts) journal_.Append(fact);
  CheckGrants(output);
  for (const std::string& line : output.log) Trace(line);
  if (crash_point_ == 1) return CrashFarm();
  const auto synced = Sync();
  if (!farm_) return;
  PlanStep(std::max(synced ? farm_->Patience(FarmNow()) : kSyncRetry, Instant(1000)));
  if (!synced) return;
  for (FarmOutput& each : std::exchange(unsynced_, {})) Answer(std::move(each));
  for (const Deliver& answer : std::exchange(after_sync_, {})) answer();
  if (journal_.IsLarge()) (void)journal_.Replace(farm_->Snapshot());
}

Result<void> Simulation::Sync() {
  for (const FrameId frame : spool_.Grown()) {
    if (auto nodes = farm_->Sums(frame)) spool_.Replace(frame, std::move(*nodes));
  }
  auto synced = spool_.Sync();
  if (synced && crash_point_ == 2) {
    CrashFarm();
    return {};
  }
  if (synced) synced = journal_.Sync();
  if (crash_point_ == 3) {
    CrashFarm();
    return {};
  }
  farm_->StorageDelayed(synced ? "" : synced.error().message);
  return synced;
}

void Simulation::Answer(FarmOutput output) {
  for (const Fact& fact : output.facts) {
    Trace("fact " + Sha256(EncodeFact(fact)).Hex().substr(0, 16));
    NoteFact(fact);
  }
  for (const auto& answer : output.results) {
    auto call = results_calls_.extract(answer.call);
    if (!call) continue;
    const ResultsCall& waiting = call.mapped();
    for (size_t i = 0; i < waiting.units.size(); ++i) {
      const Verdict verdict = answer.verdicts[i];
      if (verdict == Verdict::kAccepted || verdict == Verdict::kDuplicate)
        ledger_.Acknowledge(waiting.units[i]);
      report_.refused += verdict == Verdict::kRefused;
      report_.duplicates += verdict == Verdict::kDuplicate;
      ++report_.results;
    }
    waiting.answer(answer);
  }
  for (const auto& answer : output.directives) {
    if (auto call = directive_calls_.extract(answer.call)) call.mapped()(answer.directive);
  }
  for (const FinishedPicture& finished : output.pictures) {
    CheckPicture(finished);
    WritePicture(finished.job, finished.frame);
  }
  for (auto& [frame, nodes] : output.sums) spool_.Replace(frame, std::move(nodes));
  for (const FrameId frame : output.dropped) spool_.Drop(frame);
}

// Takes a moment; with a full disk it is tried again later.
void Simulation::WritePicture(JobId job, uint32_t frame) {
  queue_.After(random_.Duration(0, 0.2), [=, this, process = report_.crashes] {
    if (!farm_ || report_.crashes != process) return;
    if (disk_full_) {
      farm_->PictureDelayed(job, "no space left on device");
      queue_.After(kPictureRetry, [=, this] {
        if (farm_ && report_.crashes == process) WritePicture(job, frame);
      });
    } else {
      farm_->PictureWritten(FarmNow(), job, frame, Sha256(fmt::format("{} {}", Number(job), frame)));
    }
    Touch();
  });
}

SimulationReport Simulation::Run() {
  Trace(options_.Text());
  StartFarm();
  MakeJobs();
  for (int n = 0; n < options_.workers; ++n) {
    Node& node = nodes_.emplace_back();
    node.speed = random_.Real(0.7, 1.3) * (random_.Chance(options_.slow_share) ? 0.1 : 1);
    node.clock = random_.Duration(0, 1e6);
  }
  for (size_t n = 0; n < nodes_.size(); ++n) StartWorker(n);
  PlanFaults();
  const Instant limit = FromSeconds(options_.faults_s + kHealedLimit_s);
  while (!queue_.empty() && queue_.next_at() < limit && !(Healthy() && AllEnded())) queue_.RunNext();
  report_.ended_s = Seconds(queue_.now());
  CheckEnd();
  report_.trace = trace_.Finish();
  return report_;
}

}  // namespace tessera
