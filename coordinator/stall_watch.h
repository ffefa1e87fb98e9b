// Cancels calls whose peer neither takes nor sends data for a while: each holds memory, a descriptor and a
// place among the transfers. Thread safe.
#pragma once

#include <grpcpp/server_context.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace tessera {

// For a chunk of at most 1 MB; a slower peer has no use for pictures and scene files.
constexpr std::chrono::seconds kStallPatience{30};

class StallWatch {
 public:
  using Clock = std::chrono::steady_clock;

  class Call {
   public:
    explicit Call(grpc::CallbackServerContext& context) : context_(&context) {}
    // The call waits for its peer from now on. What this thread did before is visible to the one that ends
    // the wait: gRPC orders the two as well, but by means that the thread sanitizer does not see.
    void BeginWait() { since_ = Clock::now().time_since_epoch().count(); }
    void EndWait() { since_.exchange(0); }
    // The call is over.
    void End() {
      EndWait();
      const std::lock_guard lock(mutex_);
      context_ = nullptr;
    }

   private:
    friend class StallWatch;
    std::atomic<Clock::rep> since_{0};  // 0: it does not wait
    std::mutex mutex_;
    grpc::CallbackServerContext* context_;  // null once the call is over; guarded by mutex_
  };

  StallWatch();
  std::shared_ptr<Call> Watch(grpc::CallbackServerContext& context);
  // Cancels the calls that have waited for kStallPatience. Its own thread calls it every second.
  void CancelStalled(Clock::time_point now);

 private:
  std::mutex mutex_;
  std::vector<std::weak_ptr<Call>> calls_;  // guarded by mutex_
  std::jthread thread_;                     // last: it uses the others
};

}  // namespace tessera
