#include "worker/core/preparation_queue.h"

#include <algorithm>

namespace tessera {

bool PreparationQueue::Knows(const Digest& key) const {
  const std::vector<Digest> held = Held();
  return std::ranges::find(held, key) != held.end();
}

void PreparationQueue::Add(const PreparationRequest& request) {
  if (Knows(request.key) || Held().size() >= static_cast<size_t>(kPreparationsPerWorkerMax)) return;
  waiting_.push_back(request);
}

std::optional<PreparationRequest> PreparationQueue::Start() {
  if (waiting_.empty()) return std::nullopt;
  PreparationRequest request = std::move(waiting_.front());
  waiting_.pop_front();
  running_.push_back(request.key);
  return request;
}

void PreparationQueue::Finish(PreparationReport report) {
  if (std::erase(running_, report.key) == 0) return;
  reports_.push_back(std::make_shared<const PreparationReport>(std::move(report)));
}

void PreparationQueue::Answered(const Digest& key) {
  std::erase_if(reports_, [&](const Report& each) { return each->key == key; });
}

void PreparationQueue::Refuse(const Digest& key, const std::string& reason) {
  const auto found = std::ranges::find_if(reports_, [&](const Report& each) { return each->key == key; });
  if (found == reports_.end()) return;
  PreparationReport failed;
  failed.key = key;
  failed.farm = (*found)->farm;
  failed.reason = reason;
  const bool has_frames = !(*found)->frames.empty();
  reports_.erase(found);
  if (has_frames) reports_.push_back(std::make_shared<const PreparationReport>(std::move(failed)));
}

void PreparationQueue::Postpone() {
  if (reports_.size() > 1) std::rotate(reports_.begin(), reports_.begin() + 1, reports_.end());
}

void PreparationQueue::Clear() {
  waiting_.clear();
  running_.clear();
  reports_.clear();
}

std::vector<Digest> PreparationQueue::Held() const {
  std::vector<Digest> held = running_;
  for (const PreparationRequest& each : waiting_) held.push_back(each.key);
  for (const Report& each : reports_) held.push_back(each->key);
  return held;
}

}  // namespace tessera
