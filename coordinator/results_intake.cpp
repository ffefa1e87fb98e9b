#include "coordinator/results_intake.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "renderer/util/check.h"

namespace tessera {

void ResultsIntake::Enter(CallId call, uint64_t bytes, std::function<void()> admitted) {
  {
    const std::lock_guard lock(mutex_);
    line_.push_back({call, bytes, std::move(admitted)});
  }
  AdmitWhoFits();
}

void ResultsIntake::Leave(uint64_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    TESSERA_CHECK(bytes <= bytes_);
    bytes_ -= bytes;
  }
  AdmitWhoFits();
}

bool ResultsIntake::Withdraw(CallId call) {
  size_t withdrawn = 0;
  {
    const std::lock_guard lock(mutex_);
    withdrawn = std::erase_if(line_, [&](const Place& place) { return place.call == call; });
  }
  if (withdrawn > 0) AdmitWhoFits();  // it may have been a large one in front of small ones
  return withdrawn > 0;
}

void ResultsIntake::AdmitWhoFits() {
  std::vector<Place> admitted;
  {
    const std::lock_guard lock(mutex_);
    for (; !line_.empty() && HasRoom(line_.front().bytes); line_.pop_front()) {
      bytes_ += line_.front().bytes;
      admitted.push_back(std::move(line_.front()));
    }
  }
  for (const Place& place : admitted) place.admitted();
}

uint64_t ResultsIntake::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

size_t ResultsIntake::waiting() const {
  const std::lock_guard lock(mutex_);
  return line_.size();
}

}  // namespace tessera
