#include "coordinator/results_intake.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "renderer/util/check.h"

namespace tessera {

void ResultsIntake::Enter(CallId call, uint64_t bytes, std::function<void()> admitted) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back({call, bytes, std::move(admitted)});
  }
  AdmitWaiting();
}

void ResultsIntake::Leave(uint64_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    TESSERA_CHECK(bytes <= bytes_);
    bytes_ -= bytes;
  }
  AdmitWaiting();
}

bool ResultsIntake::Withdraw(CallId call) {
  size_t withdrawn = 0;
  {
    const std::lock_guard lock(mutex_);
    withdrawn = std::erase_if(queue_, [&](const Waiting& waiting) { return waiting.call == call; });
  }
  if (withdrawn > 0) AdmitWaiting();  // smaller calls may have waited behind it
  return withdrawn > 0;
}

void ResultsIntake::AdmitWaiting() {
  std::vector<Waiting> admitted;
  {
    const std::lock_guard lock(mutex_);
    for (; !queue_.empty() && HasRoom(queue_.front().bytes); queue_.pop_front()) {
      bytes_ += queue_.front().bytes;
      admitted.push_back(std::move(queue_.front()));
    }
  }
  for (const Waiting& waiting : admitted) waiting.admitted();
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
