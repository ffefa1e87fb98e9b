#include "renderer/util/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>

#include "renderer/util/threads.h"

namespace tessera {
namespace {

class ItemQueue {
 public:
  ItemQueue(size_t count, const std::stop_token& stop, const std::function<void(size_t)>& body)
      : count_(count), stop_(stop), body_(body) {}

  void Work() {
    try {
      while (!failed_ && !stop_.stop_requested()) {
        const size_t item = next_.fetch_add(1);
        if (item >= count_) return;
        body_(item);
        done_.fetch_add(1);
      }
    } catch (const std::exception& e) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = Failed(fmt::format("a thread ended with an error: {}", e.what()));
      failed_ = true;
    }
  }
  // Call after all threads have ended.
  Result<void> Outcome() const {
    if (error_) return *error_;
    if (done_ < count_) return Error{ErrorKind::kInterrupted, "interrupted"};
    return {};
  }

 private:
  const size_t count_;
  const std::stop_token& stop_;
  const std::function<void(size_t)>& body_;
  std::atomic<size_t> next_ = 0, done_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::optional<Error> error_;
};

}  // namespace

Result<void> ForEachItem(size_t count, int threads, const std::stop_token& stop,
                         const std::function<void(size_t)>& body) {
  ItemQueue queue(count, stop, body);
  {
    ThreadGroup helpers([](const Error&) {});
    const size_t helpers_wanted = std::min(static_cast<size_t>(std::max(threads, 1)), count);
    for (size_t i = 1; i < helpers_wanted; ++i) {
      if (!helpers.Start([&queue] { queue.Work(); })) break;
    }
    queue.Work();
  }
  return queue.Outcome();
}

}  // namespace tessera
