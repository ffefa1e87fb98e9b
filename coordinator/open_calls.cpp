#include "coordinator/open_calls.h"

#include <algorithm>
#include <utility>

#include "proto/shell/pause.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kRevocationInterval{250};
// People choose lifetimes of hours and more.
constexpr std::chrono::seconds kExpiryLookInterval{10};
// After a revocation, beginning with the second interval: a stream that flows ends by itself and gives its
// peer the reason. More than one, as a call may have been admitted just before the revocation and have
// entered just after the first look.
constexpr int kLooks = 3;
constexpr size_t kCompactMin = 1000;

}  // namespace

struct OpenCalls::Entry {
  Entry(grpc::CallbackServerContext* of, Principal by) : context(of), caller(std::move(by)) {}
  std::mutex mutex;
  grpc::CallbackServerContext* context;  // null once the call is over; guarded by mutex
  const Principal caller;
};

LastingCall::LastingCall(grpc::CallbackServerContext& context, Principal caller, OpenCalls& calls)
    : context_(&context), caller_(std::move(caller)), calls_(&calls), entry_(calls.Enter(context, caller_)) {}

LastingCall::~LastingCall() {
  if (entry_) OpenCalls::Leave(*entry_);
}

OpenCalls::OpenCalls(const MemberBoard& board, RecheckCaller recheck)
    : board_(board), recheck_(std::move(recheck)), thread_([this](const std::stop_token& stop) {
        while (Pause(stop, kRevocationInterval)) EndRefused(Clock::now());
      }) {}

OpenCalls::~OpenCalls() = default;

std::shared_ptr<OpenCalls::Entry> OpenCalls::Enter(grpc::CallbackServerContext& context,
                                                   const Principal& caller) {
  if (caller.member == MemberId{}) return nullptr;
  const auto entry = std::make_shared<Entry>(&context, caller);
  const std::lock_guard lock(mutex_);
  if (calls_.size() >= compact_at_) {
    std::erase_if(calls_, [](const auto& each) { return each.expired(); });
    compact_at_ = std::max(kCompactMin, 2 * calls_.size());
  }
  calls_.push_back(entry);
  return entry;
}

void OpenCalls::Leave(Entry& entry) {
  const std::lock_guard lock(entry.mutex);
  entry.context = nullptr;
}

void OpenCalls::EndRefused(Clock::time_point now) {
  const uint64_t revocations = board_.revocations();
  if (std::exchange(revocations_seen_, revocations) != revocations) {
    const bool waits = looks_due_ == 0;
    looks_due_ = kLooks;
    if (waits) return;
  }
  if (looks_due_ == 0 && now < expiry_due_) return;
  looks_due_ = std::max(0, looks_due_ - 1);
  expiry_due_ = now + kExpiryLookInterval;
  std::vector<std::shared_ptr<Entry>> calls;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& each : calls_) {
      if (auto call = each.lock()) calls.push_back(std::move(call));
    }
  }
  for (const auto& call : calls) {
    if (recheck_(call->caller).ok()) continue;
    const std::lock_guard lock(call->mutex);
    if (call->context != nullptr) call->context->TryCancel();
  }
}

}  // namespace tessera
