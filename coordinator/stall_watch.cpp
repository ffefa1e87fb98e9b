#include "coordinator/stall_watch.h"

#include "proto/shell/pause.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kStallCheckInterval{1};

}  // namespace

StallWatch::StallWatch()
    : thread_([this](const std::stop_token& stop) {
        while (Pause(stop, kStallCheckInterval)) CancelStalled(Clock::now());
      }) {}

std::shared_ptr<StallWatch::Call> StallWatch::Watch(grpc::CallbackServerContext& context) {
  auto call = std::make_shared<Call>(context);
  const std::lock_guard lock(mutex_);
  calls_.push_back(call);
  return call;
}

void StallWatch::CancelStalled(Clock::time_point now) {
  std::vector<std::shared_ptr<Call>> calls;
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(calls_, [](const auto& each) { return each.expired(); });
    for (const auto& each : calls_) {
      if (auto call = each.lock()) calls.push_back(std::move(call));
    }
  }
  for (const auto& call : calls) {
    const Clock::rep since = call->since_;
    if (since == 0 || now - Clock::time_point(Clock::duration(since)) < kStallPatience) continue;
    const std::lock_guard lock(call->mutex_);
    if (call->context_ != nullptr) call->context_->TryCancel();
  }
}

}  // namespace tessera
