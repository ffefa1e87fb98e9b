// The workload of a worker, shared by its threads under one lock. The threads that exchange states with the
// coordinator, load scenes, render and send results meet only here.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <variant>

#include "proto/terms.h"
#include "worker/core/workload.h"

namespace tessera {

// Thread safe. Waiting functions return without a result once `stop` is requested.
class SharedWorkload {
 public:
  using Clock = std::chrono::steady_clock;
  // Whether a change is one that the coordinator should learn of, apart from results.
  enum class News { kNo, kYes };

  // `on_news` is called after each change with news, from any thread and with no lock held.
  explicit SharedWorkload(std::function<void()> on_news) : on_news_(std::move(on_news)) {}

  // Access to the workload, locked until the end of the statement: `Change()->Drain()`. Then the threads that
  // wait look again. Arguments are evaluated under the lock: they must not use the SharedWorkload.
  class Changing {
   public:
    ~Changing();
    Changing(const Changing&) = delete;
    Changing& operator=(const Changing&) = delete;
    Workload* operator->() { return &shared_.load_; }

   private:
    friend class SharedWorkload;
    Changing(SharedWorkload& shared, News news) : shared_(shared), news_(news), lock_(shared.mutex_) {}
    SharedWorkload& shared_;
    const News news_;
    std::unique_lock<std::mutex> lock_;
  };
  Changing Change(News news = News::kNo) { return {*this, news}; }
  // What the coordinator is told: scenes, leases, returned leases and whether the worker drains.
  void FillState(WorkerState& state) const;

  // For the rendering threads.
  std::optional<UnitTask> AwaitUnit(std::stop_token stop);
  // For the thread that loads scenes.
  using LoaderTask = std::variant<SceneRequest, PreparationRequest>;
  std::optional<LoaderTask> AwaitLoaderTask(std::stop_token stop);
  // For the thread that sends results: Workload::NextBatch.
  Workload::Batch AwaitBatch(size_t bytes_max, std::stop_token stop);
  // Waits until nothing is being rendered and everything is returned and acknowledged, at most for
  // `patience`. Returns whether that is so.
  bool AwaitIdle(std::chrono::milliseconds patience);

 private:
  const std::function<void()> on_news_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  Workload load_;  // guarded by mutex_
};

}  // namespace tessera
