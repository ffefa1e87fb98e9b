#include "renderer/util/shared_cache.h"

namespace tessera {

uint64_t SharedCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

std::shared_ptr<const void> SharedCache::FindAny(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(key);
  if (found == entries_.end()) return nullptr;
  uses_.splice(uses_.end(), uses_, found->second.place);
  return found->second.value;
}

void SharedCache::KeepAny(const std::string& key, std::shared_ptr<const void> value, uint64_t bytes) {
  if (bytes > bytes_max_) return;
  const std::lock_guard lock(mutex_);
  if (entries_.contains(key)) return;
  while (bytes_ + bytes > bytes_max_ && !uses_.empty()) {
    const auto oldest = entries_.find(uses_.front());
    bytes_ -= oldest->second.bytes;
    entries_.erase(oldest);
    uses_.pop_front();
  }
  uses_.push_back(key);
  entries_.emplace(key, Entry{std::move(value), bytes, std::prev(uses_.end())});
  bytes_ += bytes;
}

}  // namespace tessera
