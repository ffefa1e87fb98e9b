#include "worker/core/held_leases.h"

#include <algorithm>

namespace tessera {
namespace {

// Forgotten leases that are remembered: far more than delayed messages can hold.
constexpr size_t kPastMax = 100'000;

}  // namespace

bool HeldLeases::Add(const Lease& lease, TimePoint now) {
  if (Holds(lease.id) || past_.contains(lease.id)) return false;
  entries_.push_back({lease, LeaseStage::kWaiting, now, std::make_shared<std::atomic<bool>>(false)});
  return true;
}

std::optional<HeldLeases::Started> HeldLeases::Start(const std::function<bool(const Digest&)>& is_ready,
                                                     TimePoint now) {
  for (Entry& entry : entries_) {
    if (entry.stage != LeaseStage::kWaiting || !is_ready(entry.lease.unit.scene)) continue;
    entry.stage = LeaseStage::kRunning;
    entry.since = now;
    return Started{entry.lease, entry.stop};
  }
  return std::nullopt;
}

bool HeldLeases::Finish(LeaseId id, TimePoint now) {
  const auto entry = Find(id);
  if (entry == entries_.end()) return false;
  entry->stage = LeaseStage::kReturning;
  entry->since = now;
  return true;
}

void HeldLeases::Forget(LeaseId id) {
  const auto entry = Find(id);
  if (entry == entries_.end()) {
    Remember(id);  // it may still be on its way here
    return;
  }
  *entry->stop = true;
  entries_.erase(entry);
  Remember(id);
}

void HeldLeases::Clear() {
  for (const Entry& entry : entries_) *entry.stop = true;
  entries_.clear();
  past_.clear();
  past_order_.clear();
}

std::vector<LeaseId> HeldLeases::Take(const std::function<bool(const Entry&)>& which) {
  std::vector<LeaseId> taken;
  for (const Entry& entry : entries_) {
    if (which(entry)) taken.push_back(entry.lease.id);
  }
  for (const LeaseId id : taken) Forget(id);
  return taken;
}

std::vector<LeaseId> HeldLeases::TakeWaiting() {
  return Take([](const Entry& entry) { return entry.stage == LeaseStage::kWaiting; });
}

std::vector<LeaseId> HeldLeases::TakeRunning() {
  return Take([](const Entry& entry) { return entry.stage == LeaseStage::kRunning; });
}

std::vector<LeaseId> HeldLeases::TakeScene(const Digest& scene) {
  return Take([&](const Entry& entry) {
    return entry.lease.unit.scene == scene && entry.stage != LeaseStage::kReturning;
  });
}

std::list<HeldLeases::Entry>::iterator HeldLeases::Find(LeaseId id) {
  return std::ranges::find(entries_, id, [](const Entry& entry) { return entry.lease.id; });
}

void HeldLeases::Remember(LeaseId id) {
  if (!past_.insert(id).second) return;
  past_order_.push_back(id);
  if (past_order_.size() <= kPastMax) return;
  past_.erase(past_order_.front());
  past_order_.pop_front();
}

bool HeldLeases::Holds(LeaseId id) const {
  return std::ranges::any_of(entries_, [id](const Entry& entry) { return entry.lease.id == id; });
}

bool HeldLeases::Uses(const Digest& scene) const {
  return std::ranges::any_of(entries_, [&](const Entry& entry) { return entry.lease.unit.scene == scene; });
}

size_t HeldLeases::running() const {
  return static_cast<size_t>(std::ranges::count_if(
      entries_, [](const Entry& entry) { return entry.stage == LeaseStage::kRunning; }));
}

std::vector<HeldLease> HeldLeases::Held(TimePoint now) const {
  std::vector<HeldLease> held;
  held.reserve(entries_.size());
  for (const Entry& entry : entries_) {
    const auto duration = std::chrono::duration_cast<std::chrono::milliseconds>(now - entry.since);
    held.push_back({entry.lease.id, entry.lease.unit, entry.stage, duration});
  }
  return held;
}

std::optional<std::chrono::milliseconds> HeldLeases::ShortestDuration() const {
  std::optional<std::chrono::milliseconds> shortest;
  for (const Entry& entry : entries_) {
    if (!shortest || entry.lease.duration < *shortest) shortest = entry.lease.duration;
  }
  return shortest;
}

}  // namespace tessera
