#include "coordinator/core/schedule/worker_roster.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace tessera {

WorkerRecord* WorkerRoster::Find(WorkerId id) {
  const auto found = by_id_.find(id);
  return found == by_id_.end() ? nullptr : found->second;
}

const WorkerRecord* WorkerRoster::Find(WorkerId id) const {
  const auto found = by_id_.find(id);
  return found == by_id_.end() ? nullptr : found->second;
}

WorkerRecord& WorkerRoster::FindOrAdd(WorkerId id) {
  WorkerRecord*& known = by_id_[id];
  if (known == nullptr) known = &workers_[id];
  known->id = id;
  return *known;
}

void WorkerRoster::UpdateGone(WorkerRecord& worker) {
  UpdateFaulty(worker);
  if (!worker.is_live && worker.is_blocked()) {
    gone_blocked_.insert(worker.id);
  } else {
    gone_blocked_.erase(worker.id);
  }
  const bool is_gone = !worker.is_live && !worker.is_blocked();
  if (is_gone == worker.gone_since_.has_value()) return;
  if (is_gone) {
    worker.gone_since_ = worker.last_contact;
    gone_.emplace(*worker.gone_since_, worker.id);
  } else {
    gone_.erase({*worker.gone_since_, worker.id});
    worker.gone_since_.reset();
  }
}

std::optional<WorkerId> WorkerRoster::MakePlace() {
  if (workers_.size() < kWorkersMax || gone_.empty()) return std::nullopt;
  const WorkerId id = gone_.begin()->second;
  Forget(id);
  return id;
}

void WorkerRoster::Forget(WorkerId id) {
  WorkerRecord& worker = *by_id_.at(id);
  worker.has_joined = false;
  UpdateFaulty(worker);
  if (worker.gone_since_) gone_.erase({*worker.gone_since_, id});
  gone_blocked_.erase(id);
  news_.erase(id);
  by_id_.erase(id);
  workers_.erase(id);
}

std::pair<WorkerRecord*, bool> WorkerRoster::Admit(Instant now, const WorkerState& state) {
  WorkerRecord& worker = FindOrAdd(state.worker);
  const bool is_new = !worker.is_live;
  if (is_new) {
    worker.is_live = true;
    worker.pending.has_notice = worker.is_blocked();
    if (worker.is_blocked()) news_.insert(state.worker);
  }
  worker.member = state.member;
  worker.name = state.name;
  worker.software_version = state.software_version;
  worker.tags = state.tags;
  worker.memory_bytes = state.memory_bytes;
  worker.machine = state.machine;
  worker.slots = state.slots;
  worker.is_leaving = state.draining;
  worker.has_joined = true;
  worker.last_contact = now;
  UpdateGone(worker);
  return {&worker, is_new};
}

void WorkerRoster::Disconnect(Instant now, WorkerRecord& worker) {
  worker.is_live = false;
  worker.last_contact = now;
  worker.scenes.clear();
  worker.wanted.clear();
  worker.loading_since.clear();
  worker.prefetch.clear();
  worker.pending.has_prefetch = false;
  UpdateGone(worker);
}

std::vector<WorkerId> WorkerRoster::Silent(Instant now) const {
  std::vector<WorkerId> silent;
  for (const auto& [id, worker] : workers_) {
    if (worker.is_live && now - worker.last_contact > kWorkerSilenceMax) silent.push_back(id);
  }
  return silent;
}

std::vector<WorkerId> WorkerRoster::ForgetGone(Instant now) {
  std::vector<WorkerId> gone;
  for (const auto& [id, worker] : workers_) {
    const bool has_failed = worker.member != MemberId{} && worker.units_failed + worker.strikes > 0;
    const Instant patience = worker.is_blocked() ? kBlockForgotten
                             : has_failed        ? kFailedWorkerForgotten
                                                 : kWorkerForgotten;
    if (!worker.is_live && now - worker.last_contact > patience) gone.push_back(id);
  }
  for (const WorkerId id : gone) Forget(id);
  return gone;
}

void WorkerRoster::MeasureSpeed(WorkerRecord& worker, double cost, double seconds, bool is_tile_measured) {
  const double observed = cost / seconds;
  const double first = 1.0 / static_cast<double>(worker.speed_measurements + 1);
  double gain = std::max(kSpeedGain, first) * std::min(1.0, seconds / kSpeedUnitDuration_s);
  // A tile that was never measured may differ from the average for reasons of its own.
  if (!is_tile_measured) gain /= 4;
  worker.speed = std::clamp(worker.speed * std::pow(observed / worker.speed, gain), kSpeedMin, kSpeedMax);
  ++worker.speed_measurements;
  UpdateTotals(worker);
}

void WorkerRoster::UpdateTotals(WorkerRecord& worker) {
  const int slots = worker.may_work() ? worker.slots : 0;
  const double speed = slots * worker.speed;
  total_slots_ += slots - worker.slots_counted_;
  total_speed_ = total_slots_ == 0 ? 0 : total_speed_ + speed - worker.speed_counted_;
  worker.slots_counted_ = slots;
  worker.speed_counted_ = speed;
  CountMachine(worker);
}

void WorkerRoster::CountMachine(WorkerRecord& worker) {
  const std::optional<uint64_t> machine = worker.may_work() ? std::optional(worker.machine) : std::nullopt;
  if (machine == worker.machine_counted_) return;
  if (machine) ++machines_[*machine];
  if (worker.machine_counted_) {
    const auto before = machines_.find(*worker.machine_counted_);
    if (--before->second == 0) machines_.erase(before);
  }
  worker.machine_counted_ = machine;
}

void WorkerRoster::UpdateSlotUse(WorkerRecord& worker, size_t lease_count) {
  SlotUse use;
  if (worker.is_live) {
    use.leased = std::min(worker.slots, static_cast<int>(lease_count));
    const int rest = worker.slots - use.leased;
    (worker.is_fetching ? use.fetching : worker.is_loading() ? use.loading : use.idle) = rest;
  }
  occupancy_.Change(worker.use_counted_, use);
  worker.use_counted_ = use;
}

std::set<WorkerId> WorkerRoster::AbleFor(const std::set<std::string>& tags) const {
  std::set<WorkerId> able;
  for (const auto& [id, worker] : workers_) {
    if (worker.may_work() && worker.has_tags(tags)) able.insert(id);
  }
  return able;
}

std::set<Party> WorkerRoster::PartiesFor(const std::set<std::string>& tags) const {
  std::set<Party> parties;
  for (const auto& [id, worker] : workers_) {
    if (worker.may_work() && worker.has_tags(tags)) parties.insert(PartyOf(worker.member, id));
  }
  return parties;
}

// Why the connected workers that have the tags take no work, counted; empty if there are no such workers.
std::string WorkerRoster::WhyIdle(const std::set<std::string>& tags) const {
  size_t drained = 0, quarantined = 0, leaving = 0;
  for (const auto& [id, worker] : workers_) {
    if (!worker.is_live || !worker.has_tags(tags)) continue;
    ++(worker.is_quarantined() ? quarantined : worker.is_drained ? drained : leaving);
  }
  std::string why;
  for (const auto& [count, what] : {std::pair(drained, "drained"), std::pair(quarantined, "quarantined"),
                                    std::pair(leaving, "about to leave")}) {
    if (count > 0) why += fmt::format("{}{} {}", why.empty() ? "" : ", ", count, what);
  }
  return why;
}

std::string WorkerRoster::WhyNoneFor(const std::set<std::string>& tags) const {
  const std::string why = WhyIdle(tags);
  if (tags.empty()) return why.empty() ? "no worker is connected" : "no worker accepts work: " + why;
  const std::string all = fmt::format("{}", fmt::join(tags, ", "));
  if (!why.empty())
    return fmt::format("no worker with tag{} {} accepts work: {}", tags.size() == 1 ? "" : "s", all, why);
  std::set<std::string> missing = tags;
  for (const auto& [id, worker] : workers_) {
    if (!worker.is_live) continue;
    for (const std::string& tag : worker.tags) missing.erase(tag);
  }
  const std::string reason = missing.empty() ? fmt::format("no worker has all of the tags {}", all)
                                             : fmt::format("no worker has tag {}", *missing.begin());
  const size_t away = CountAway(tags);
  if (away == 0) return reason;
  return fmt::format("no connected worker has tag{} {}; {} that had {} gone", tags.size() == 1 ? "" : "s",
                     all, away, away == 1 ? "is" : "are");
}

size_t WorkerRoster::CountAway(const std::set<std::string>& tags) const {
  return static_cast<size_t>(std::count_if(workers_.begin(), workers_.end(), [&](const auto& each) {
    return !each.second.is_live && each.second.has_joined && each.second.has_tags(tags);
  }));
}

void WorkerRoster::Announce(WorkerRecord& worker, LeaseId lease) {
  worker.pending.leases.push_back(lease);
  news_.insert(worker.id);
}

void WorkerRoster::Drop(WorkerRecord& worker, LeaseId lease) {
  // If the worker lists the lease again, the drop is sent again.
  if (worker.pending.drops.size() < size_t{kLeasesPerWorkerMax}) worker.pending.drops.push_back(lease);
  news_.insert(worker.id);
}

void WorkerRoster::Revoke(WorkerRecord& worker, LeaseId lease) {
  Drop(worker, lease);
  worker.revoked.insert(lease);
  if (worker.revoked.size() > kRevokedKeptMax) worker.revoked.erase(worker.revoked.begin());
}

void WorkerRoster::RequestScene(WorkerRecord& worker, const SceneRequest& scene) {
  worker.wanted = {scene};
  worker.pending.has_scenes = true;
  news_.insert(worker.id);
}

void WorkerRoster::RequestPrefetch(WorkerRecord& worker, std::vector<Digest> packages) {
  worker.prefetch = std::move(packages);
  worker.pending.has_prefetch = !worker.prefetch.empty();
  if (worker.pending.has_prefetch) news_.insert(worker.id);
}

bool WorkerRoster::HasNews(WorkerId id) const {
  const WorkerRecord* const worker = Find(id);
  return worker != nullptr && !worker->pending.empty();
}

void WorkerRoster::UpdateNews(const WorkerRecord& worker) {
  if (worker.pending.empty() || !worker.is_live) {
    news_.erase(worker.id);
  } else {
    news_.insert(worker.id);
  }
}

WorkerDirective WorkerRoster::TakeRequests(Instant now, WorkerRecord& worker) {
  WorkerDirective directive;
  for (const SceneRequest& scene : worker.wanted) {
    if (worker.scenes.contains(scene.key)) continue;
    directive.scenes.push_back(scene);
    worker.loading_since.try_emplace(scene.key, now);
  }
  if (worker.pending.has_prefetch) directive.prefetch = worker.prefetch;
  directive.notice = worker.is_quarantined() ? worker.quarantine
                     : worker.is_drained     ? "drained by a user"
                                             : "";
  worker.pending.has_scenes = worker.pending.has_prefetch = worker.pending.has_notice = false;
  UpdateNews(worker);
  return directive;
}

std::vector<WorkerStatus> WorkerRoster::Statuses(Instant now, const LeaseTable& leases) const {
  std::vector<WorkerStatus> all;
  const double average = total_slots_ > 0 ? total_speed_ / total_slots_ : 1;
  for (const auto& [id, worker] : workers_) {
    if (!worker.is_live) continue;
    WorkerStatus status;
    status.worker = id;
    status.name = worker.name;
    status.slots = worker.slots;
    status.software_version = worker.software_version;
    status.leases = static_cast<uint32_t>(leases.OfWorker(id).size());
    status.units_finished = worker.units_finished;
    status.units_failed = worker.units_failed;
    status.speed = worker.speed / average;
    status.silent = std::chrono::duration_cast<std::chrono::milliseconds>(now - worker.last_contact);
    status.draining = worker.is_leaving || worker.is_drained;
    status.quarantined = worker.is_quarantined();
    status.reason = worker.quarantine;
    status.utilisation = worker.pace.Utilisation(worker.slots);
    status.samples_per_second = worker.pace.SamplesPerSecond(now);
    status.fetching = worker.is_fetching;
    status.loading = worker.is_loading();
    status.tags = worker.tags;
    status.memory_bytes = worker.memory_bytes;
    status.last_failure = worker.last_failure;
    all.push_back(std::move(status));
  }
  return all;
}

}  // namespace tessera
