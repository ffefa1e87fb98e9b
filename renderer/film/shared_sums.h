// Sums of samples that several owners read and nobody changes: a merger, the spool and the painter of a
// preview hold the same bytes instead of copies.
#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace tessera {

// Copying it copies a pointer. Copies may be read and destroyed on different threads.
class SharedSums {
 public:
  SharedSums() : SharedSums(std::vector<float>()) {}
  SharedSums(std::vector<float> sums) : sums_(std::make_shared<const std::vector<float>>(std::move(sums))) {}

  const std::vector<float>& operator*() const { return *sums_; }
  const std::vector<float>* operator->() const { return sums_.get(); }
  // Compares values, not pointers.
  bool operator==(const SharedSums& other) const { return *sums_ == *other.sums_; }

 private:
  std::shared_ptr<const std::vector<float>> sums_;
};

}  // namespace tessera
