// Values that are expensive to make, kept to be used again: decoded pictures, parsed meshes.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace tessera {

// Bounded: least recently used values are evicted first. An evicted value lives on while it is used.
// Thread safe.
class SharedCache {
 public:
  explicit SharedCache(uint64_t bytes_max) : bytes_max_(bytes_max) {}

  // Returns null if there is none. All values of a key must have the same type: name the type in it.
  template <typename T>
  std::shared_ptr<const T> Find(const std::string& key) {
    return std::static_pointer_cast<const T>(FindAny(key));
  }
  // Keeps the value, unless it is larger than the whole cache or the key is there already.
  template <typename T>
  void Keep(const std::string& key, std::shared_ptr<const T> value, uint64_t bytes) {
    KeepAny(key, std::move(value), bytes);
  }
  uint64_t bytes() const;

 private:
  struct Entry {
    std::shared_ptr<const void> value;
    uint64_t bytes = 0;
    std::list<std::string>::iterator place;  // in uses_
  };
  std::shared_ptr<const void> FindAny(const std::string& key);
  void KeepAny(const std::string& key, std::shared_ptr<const void> value, uint64_t bytes);

  const uint64_t bytes_max_;
  mutable std::mutex mutex_;
  uint64_t bytes_ = 0;
  std::map<std::string, Entry> entries_;
  std::list<std::string> uses_;  // keys, least recently used first
};

}  // namespace tessera
