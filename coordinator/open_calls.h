// The calls of members that last: streams, and calls that wait for news. Ends them soon after their member
// is revoked or its certificate expires. Thread safe.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "coordinator/access.h"
#include "coordinator/membership/member_board.h"

namespace tessera {

class OpenCalls {
 public:
  using Clock = std::chrono::steady_clock;
  // UNAUTHENTICATED with the reason if the certificate of the caller no longer holds.
  using RecheckCaller = std::function<grpc::Status(const Principal& caller)>;
  struct Entry;

  OpenCalls(const MemberBoard& board, RecheckCaller recheck);
  ~OpenCalls();
  // Returns nullptr for a caller that is no member.
  std::shared_ptr<Entry> Enter(grpc::CallbackServerContext& context, const Principal& caller);
  static void Leave(Entry& entry);
  grpc::Status Recheck(const Principal& caller) const { return recheck_(caller); }
  // Cancels the calls whose callers are refused. Looks at them only if somebody was revoked since the last
  // time, or if that is some seconds ago. Its own thread calls it several times per second.
  void EndRefused(Clock::time_point now);

 private:
  const MemberBoard& board_;
  const RecheckCaller recheck_;
  std::mutex mutex_;
  std::vector<std::weak_ptr<Entry>> calls_;  // guarded by mutex_; some are over
  size_t compact_at_ = 0;                    // guarded by mutex_
  uint64_t revocations_seen_ = 0;            // of the thread
  int looks_due_ = 0;                        // of the thread
  Clock::time_point expiry_due_{};           // of the thread
  std::jthread thread_;                      // last: it uses the others
};

// An admitted call that lasts, as a member of its reactor, which it must not outlive.
class LastingCall {
 public:
  LastingCall(grpc::CallbackServerContext& context, Principal caller, OpenCalls& calls);
  ~LastingCall();
  LastingCall(LastingCall&&) = default;
  LastingCall& operator=(LastingCall&&) = delete;

  grpc::CallbackServerContext& context() const { return *context_; }
  const Principal& caller() const { return caller_; }
  // Streams ask between two messages, so that a revoked peer learns the reason; a peer that lets the stream
  // wait is cut off.
  grpc::Status Recheck() const { return calls_->Recheck(caller_); }

 private:
  grpc::CallbackServerContext* context_;
  Principal caller_;
  const OpenCalls* calls_;
  std::shared_ptr<OpenCalls::Entry> entry_;
};

}  // namespace tessera
