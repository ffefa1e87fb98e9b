#include "tests/chaos/farm_history.h"

#include <algorithm>
#include <utility>

namespace tessera {

void FarmHistory::BeginChange() {
  const std::lock_guard lock(mutex_);
  ++change_;
}

void FarmHistory::EndChange() {
  const std::lock_guard lock(mutex_);
  ++change_;
}

void FarmHistory::SetAddress(int farm, std::string address) {
  const std::lock_guard lock(mutex_);
  farms_.at(static_cast<size_t>(farm)).address = std::move(address);
}

void FarmHistory::NoteBackup(int farm) {
  const std::lock_guard lock(mutex_);
  ++farms_.at(static_cast<size_t>(farm)).backup;
}

void FarmHistory::NoteRestored(int farm) {
  const std::lock_guard lock(mutex_);
  Farm& restored = farms_.at(static_cast<size_t>(farm));
  restored.restores.push_back({change_, restored.backup});
}

uint64_t FarmHistory::change() const {
  const std::lock_guard lock(mutex_);
  return change_;
}

std::string FarmHistory::Address(int farm) const {
  const std::lock_guard lock(mutex_);
  return farms_.at(static_cast<size_t>(farm)).address;
}

// A job whose acceptance was answered while a backup was made counts as submitted after it, though the backup
// may have it.
FarmHistory::Place FarmHistory::Now(int farm) const {
  const std::lock_guard lock(mutex_);
  return {farm, change_, farms_.at(static_cast<size_t>(farm)).backup};
}

bool FarmHistory::IsLost(const Place& place) const {
  const std::lock_guard lock(mutex_);
  const auto& restores = farms_.at(static_cast<size_t>(place.farm)).restores;
  return std::ranges::any_of(restores, [&](const Restore& restore) {
    return restore.change > place.change && restore.backup <= place.backup;
  });
}

}  // namespace tessera
