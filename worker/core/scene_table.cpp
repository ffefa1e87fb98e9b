#include "worker/core/scene_table.h"

#include <algorithm>

namespace tessera {

void SceneTable::Want(const std::vector<SceneRequest>& orders,
                      const std::function<bool(const Digest&)>& in_use) {
  wanted_ = orders;
  const auto is_wanted = [&](const Digest& key) {
    return std::ranges::any_of(wanted_, [&](const SceneRequest& order) { return order.key == key; });
  };
  std::erase_if(failed_, [&](const auto& failure) { return !is_wanted(failure.first); });
  while (entries_.size() > kScenesHeldMax) {
    auto victim = entries_.end();
    for (auto it = entries_.begin(); it != entries_.end(); ++it) {
      if (it->second.scene == nullptr || is_wanted(it->first) || in_use(it->first)) continue;
      if (victim == entries_.end() || it->second.used < victim->second.used) victim = it;
    }
    if (victim == entries_.end()) return;
    entries_.erase(victim);
  }
}

std::optional<SceneRequest> SceneTable::StartLoading(TimePoint now) {
  for (const SceneRequest& order : wanted_) {
    if (entries_.contains(order.key)) continue;
    const auto failure = failed_.find(order.key);
    if (failure != failed_.end() && now - failure->second < kSceneRetryInterval) continue;
    failed_.erase(order.key);
    entries_[order.key].used = ++uses_;
    return order;
  }
  return std::nullopt;
}

std::optional<SceneTable::TimePoint> SceneTable::NextRetry() const {
  std::optional<TimePoint> next;
  for (const auto& [key, when] : failed_) {
    const TimePoint retry = when + kSceneRetryInterval;
    if (!next || retry < *next) next = retry;
  }
  return next;
}

void SceneTable::Loaded(const Digest& key, ScenePointer scene) {
  entries_[key].scene = std::move(scene);
}

void SceneTable::Failed(const Digest& key, TimePoint now) {
  entries_.erase(key);
  const bool wanted =
      std::ranges::any_of(wanted_, [&](const SceneRequest& order) { return order.key == key; });
  if (wanted) failed_[key] = now;
}

bool SceneTable::IsReady(const Digest& key) const {
  const auto entry = entries_.find(key);
  return entry != entries_.end() && entry->second.scene != nullptr;
}

bool SceneTable::Expects(const Digest& key) const {
  return entries_.contains(key) ||
         std::ranges::any_of(wanted_, [&](const SceneRequest& order) { return order.key == key; });
}

SceneTable::ScenePointer SceneTable::Use(const Digest& key) {
  const auto entry = entries_.find(key);
  if (entry == entries_.end()) return nullptr;
  entry->second.used = ++uses_;
  return entry->second.scene;
}

std::vector<HeldScene> SceneTable::Held() const {
  std::vector<HeldScene> held;
  for (const auto& [key, entry] : entries_) held.push_back({key, entry.scene != nullptr});
  return held;
}

}  // namespace tessera
