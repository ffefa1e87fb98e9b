#include "coordinator/results_intake.h"

#include <algorithm>
#include <utility>

#include "renderer/util/check.h"

namespace tessera {
namespace {

// Senders are connections, which come and go.
constexpr size_t kLapsedMax = 10'000;

}  // namespace

void ResultsIntake::Enter(Call call) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(call));
  }
  AdmitWaiting();
}

void ResultsIntake::Arrived(CallId call) {
  const std::lock_guard lock(mutex_);
  Admitted& admitted = admitted_.at(call);
  admitted.has_arrived = true;
  lapsed_.erase(admitted.sender);
}

void ResultsIntake::Shrink(CallId call, uint64_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    Admitted& admitted = admitted_.at(call);
    const uint64_t released = admitted.bytes - std::min(admitted.bytes, bytes);
    admitted.bytes -= released;
    bytes_ -= released;
  }
  AdmitWaiting();
}

void ResultsIntake::Leave(CallId call) {
  {
    const std::lock_guard lock(mutex_);
    const auto left = admitted_.extract(call);
    TESSERA_CHECK(!left.empty());
    bytes_ -= left.mapped().bytes;
    const auto calls = calls_of_.find(left.mapped().sender);
    if (--calls->second == 0) calls_of_.erase(calls);
  }
  AdmitWaiting();
}

bool ResultsIntake::Withdraw(CallId call) {
  size_t withdrawn = 0;
  {
    const std::lock_guard lock(mutex_);
    withdrawn = std::erase_if(queue_, [&](const Call& waiting) { return waiting.id == call; });
  }
  if (withdrawn > 0) AdmitWaiting();  // smaller calls may have waited for it
  return withdrawn > 0;
}

// The call to be admitted next, which others do not overtake even if they would fit.
std::deque<ResultsIntake::Call>::iterator ResultsIntake::Next() {
  const auto first = std::ranges::find_if(queue_, [this](const Call& call) {
    return !calls_of_.contains(call.sender) && !lapsed_.contains(call.sender);
  });
  if (first != queue_.end()) return first;
  const auto second =
      std::ranges::find_if(queue_, [this](const Call& call) { return !lapsed_.contains(call.sender); });
  return second != queue_.end() ? second : queue_.begin();
}

void ResultsIntake::AdmitWaiting() {
  std::vector<std::function<void()>> admitted;
  {
    const std::lock_guard lock(mutex_);
    while (!queue_.empty()) {
      const auto next = Next();
      if (!HasRoom(next->bytes)) break;
      bytes_ += next->bytes;
      ++calls_of_[next->sender];
      admitted.push_back(std::move(next->admitted));
      admitted_[next->id] = {std::move(next->sender), next->bytes, false, false, Clock::now(),
                             std::move(next->expired)};
      queue_.erase(next);
    }
  }
  for (const auto& call : admitted) call();
}

void ResultsIntake::Expire(Clock::time_point now) {
  std::vector<std::function<void()>> expired;
  {
    const std::lock_guard lock(mutex_);
    if (queue_.empty()) return;
    for (auto& [id, call] : admitted_) {
      if (call.has_arrived || call.is_expired) continue;
      const auto patience = calls_of_.at(call.sender) > 1 ? kSecondArrivalPatience : kArrivalPatience;
      if (now - call.since < patience) continue;
      call.is_expired = true;
      if (lapsed_.size() == kLapsedMax) lapsed_.clear();
      lapsed_.insert(call.sender);
      expired.push_back(call.expired);
    }
  }
  for (const auto& call : expired) call();
}

uint64_t ResultsIntake::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

size_t ResultsIntake::waiting() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

}  // namespace tessera
