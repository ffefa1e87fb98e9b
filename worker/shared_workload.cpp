#include "worker/shared_workload.h"

namespace tessera {

SharedWorkload::Changing::~Changing() {
  lock_.unlock();
  shared_.changed_.notify_all();
  if (news_ == News::kYes) shared_.on_news_();
}

void SharedWorkload::FillState(WorkerState& state) const {
  const std::lock_guard lock(mutex_);
  load_.FillState(state, Clock::now());
}

std::optional<UnitTask> SharedWorkload::AwaitUnit(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  std::optional<UnitTask> task;
  changed_.wait(lock, stop, [&] {
    task = load_.StartUnit(Clock::now());
    return task.has_value();
  });
  return task;
}

// Scenes of work units come before preparations, since render threads may wait for them.
std::optional<SharedWorkload::LoaderTask> SharedWorkload::AwaitLoaderTask(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  std::optional<LoaderTask> order;
  const auto has_order = [&] {
    if (auto scene = load_.StartScene(Clock::now())) {
      order = std::move(*scene);
    } else if (auto preparation = load_.StartPreparation()) {
      order = std::move(*preparation);
    }
    return order.has_value();
  };
  while (!order && !stop.stop_requested()) {
    if (has_order()) break;
    // A change may bring a retry, so wait for one change only.
    if (const auto retry = load_.NextRetry()) {
      changed_.wait_until(lock, stop, *retry, has_order);
    } else {
      changed_.wait(lock, stop, [&] { return has_order() || load_.NextRetry().has_value(); });
    }
  }
  return order;
}

Workload::Batch SharedWorkload::AwaitBatch(size_t bytes_max, std::stop_token stop) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, stop, [this] { return load_.HasBatch(); });
  return load_.NextBatch(bytes_max);
}

bool SharedWorkload::AwaitIdle(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, patience, [this] { return load_.IsIdle(); });
}

}  // namespace tessera
