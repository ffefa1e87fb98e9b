#include "renderer/util/load_budget.h"

#include <utility>

namespace tessera {

void LoadBudget::Cancel(const std::string& reason) {
  // The allocations of this function are not the scene's.
  LoadBudget* const current = std::exchange(current_, nullptr);
  {
    const std::lock_guard lock(mutex_);
    if (reason_.empty()) reason_ = reason;
    is_exceeded_ = true;
  }
  current_ = current;
}

std::string LoadBudget::reason() const {
  const std::lock_guard lock(mutex_);
  return reason_;
}

}  // namespace tessera
