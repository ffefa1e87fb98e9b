#include "worker/core/workload.h"

#include "renderer/film/radiance_tile.h"

#include <algorithm>

namespace tessera {
namespace {

// A held lease is reported this many times before it would expire.
constexpr int kReportsPerLease = 3;

void Append(std::vector<LeaseId>& to, const std::vector<LeaseId>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

// Leases of another farm mean nothing to this one, and its jobs may have the same numbers. Scenes are named
// by what they are made of, so those in memory are as good as before.
void Workload::JoinFarm(FarmId farm) {
  if (farm == farm_) return;
  leases_.Clear();
  results_.clear();
  failures_.clear();
  results_first_ = false;
  returned_.clear();
  preparations_.Clear();
  scenes_.Want({}, [](const Digest&) { return false; });
  farm_ = farm;
}

void Workload::Apply(const WorkerDirective& directive, TimePoint now) {
  JoinFarm(directive.farm);
  if (!draining_) scenes_.Want(directive.scenes, [this](const Digest& key) { return leases_.Uses(key); });
  if (!draining_ && directive.preparation) preparations_.Add(*directive.preparation);
  AddLeases(directive.leases, directive.drop, now);
}

void Workload::ApplyOvertaken(const WorkerDirective& directive, TimePoint now) {
  JoinFarm(directive.farm);
  if (!draining_ && directive.preparation) preparations_.Add(*directive.preparation);
  AddLeases(directive.leases, directive.drop, now);
}

void Workload::AddLeases(FarmId farm, const std::vector<Lease>& leases, const std::vector<LeaseId>& drop,
                         TimePoint now) {
  if (farm == farm_) AddLeases(leases, drop, now);
}

void Workload::AddLeases(const std::vector<Lease>& leases, const std::vector<LeaseId>& drop, TimePoint now) {
  for (const Lease& lease : leases) {
    if (!leases_.Add(lease, now)) continue;
    if (!draining_ && scenes_.Expects(lease.unit.scene)) continue;
    leases_.Forget(lease.id);
    returned_.push_back(lease.id);
  }
  for (const LeaseId id : drop) {
    leases_.Forget(id);
    std::erase_if(results_, [id](const FinishedUnit& unit) { return unit.lease == id; });
  }
}

void Workload::FillState(WorkerState& state, TimePoint now) const {
  state.farm = farm_;
  state.scenes = scenes_.Held();
  state.leases = leases_.Held(now);
  state.returned_leases = returned_;
  state.preparations = preparations_.Held();
  state.draining = draining_;
  state.wait = kSynchronizeWaitMax;
  if (const auto shortest = leases_.ShortestDuration())
    state.wait = std::min(state.wait, *shortest / kReportsPerLease);
}

void Workload::ReturnsAcknowledged(const std::vector<LeaseId>& returned) {
  std::erase_if(returned_, [&](LeaseId id) { return std::ranges::find(returned, id) != returned.end(); });
}

std::optional<UnitTask> Workload::StartUnit(TimePoint now) {
  const auto is_ready = [this](const Digest& key) { return scenes_.IsReady(key); };
  const auto started = leases_.Start(is_ready, now);
  if (!started) return std::nullopt;
  return UnitTask{started->lease, scenes_.Use(started->lease.unit.scene), started->stop};
}

bool Workload::UnitFinished(FinishedUnit unit, TimePoint now) {
  if (!leases_.Finish(unit.lease, now)) return false;
  unit.farm = farm_;
  results_.push_back(std::move(unit));
  return true;
}

void Workload::UnitFailed(const Lease& lease, std::string reason) {
  if (!leases_.Holds(lease.id)) return;  // it was dropped meanwhile
  leases_.Forget(lease.id);
  AddFailure({lease.id, lease.unit, lease.unit.scene, std::move(reason)});
}

void Workload::AddFailure(FailureReport failure) {
  failure.farm = farm_;
  failure.number = ++failure_count_;
  failures_.push_back(std::move(failure));
}

void Workload::FailureAnswered(const FailureReport& failure) {
  reports_last_ = false;
  std::erase_if(failures_, [&](const FailureReport& each) { return each.number == failure.number; });
}

std::optional<SceneRequest> Workload::StartScene(TimePoint now) {
  if (draining_) return std::nullopt;
  return scenes_.StartLoading(now);
}

void Workload::SceneLoaded(const Digest& key, SceneTable::ScenePointer scene) {
  scenes_.Loaded(key, std::move(scene));
}

void Workload::SceneFailed(const Digest& key, std::string reason, FailureCause cause, TimePoint now) {
  scenes_.Failed(key, now);
  Append(returned_, leases_.TakeScene(key));
  AddFailure({LeaseId{}, {}, key, std::move(reason), cause});
}

std::optional<PreparationRequest> Workload::StartPreparation() {
  if (draining_) return std::nullopt;
  return preparations_.Start();
}

void Workload::PreparationFinished(PreparationReport report) {
  report.farm = farm_;
  preparations_.Finish(std::move(report));
}

void Workload::PreparationAnswered(const PreparationReport& report) {
  preparations_.Answered(report.key);
}

Workload::Batch Workload::NextBatch(size_t bytes_max) const {
  const bool has_others = !failures_.empty() || !results_.empty();
  if (const auto report = preparations_.NextReport(); report != nullptr && !(reports_last_ && has_others))
    return report;
  if (!failures_.empty() && !(results_first_ && !results_.empty())) return failures_.front();
  if (results_.empty()) return {};
  std::vector<FinishedUnit> results;
  size_t bytes = 0;
  for (const FinishedUnit& result : results_) {
    bytes += results.empty() ? 0 : DecodedSize(result.tile);
    if (bytes > bytes_max || results.size() == static_cast<size_t>(kResultsPerCallMax)) break;
    results.push_back(result);
  }
  return results;
}

void Workload::Postpone(const Batch& batch) {
  reports_last_ = std::holds_alternative<PreparationQueue::Report>(batch);
  if (reports_last_) return preparations_.Postpone();
  results_first_ = std::holds_alternative<FailureReport>(batch);
  if (results_first_ && failures_.size() > 1)
    std::rotate(failures_.begin(), failures_.begin() + 1, failures_.end());
  const auto* const results = std::get_if<std::vector<FinishedUnit>>(&batch);
  if (results == nullptr) return;
  for (const FinishedUnit& result : *results) {
    const auto at = std::ranges::find(results_, result.lease, &FinishedUnit::lease);
    if (at != results_.end()) std::rotate(at, at + 1, results_.end());
  }
}

void Workload::ResultsAnswered(const std::vector<FinishedUnit>& results) {
  results_first_ = reports_last_ = false;
  for (const FinishedUnit& answered : results) {
    leases_.Forget(answered.lease);
    std::erase_if(results_, [&](const FinishedUnit& unit) { return unit.lease == answered.lease; });
  }
}

void Workload::Drain() {
  draining_ = true;
  preparations_.Drain();
  Append(returned_, leases_.TakeWaiting());
}

bool Workload::IsIdle() const {
  return leases_.running() == 0 && results_.empty() && failures_.empty() && returned_.empty() &&
         preparations_.NextReport() == nullptr;
}

void Workload::StopRendering() {
  Append(returned_, leases_.TakeRunning());
}

}  // namespace tessera
