// Lists that fit into one answer.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <cstddef>
#include <cstdint>

namespace tessera {

// Bytes of a list in an answer, below the message limit: an answer beyond that never arrives.
constexpr size_t kListBytesMax = size_t{16} << 20;

// Removes as many elements at the front as the list is too large. Returns their number.
template <typename Element>
uint64_t KeepLast(google::protobuf::RepeatedPtrField<Element>& list) {
  constexpr size_t kHeadBytes = 8;  // tag and length of an element
  size_t bytes = 0;
  int first = list.size();
  while (first > 0) {
    bytes += list.Get(first - 1).ByteSizeLong() + kHeadBytes;
    if (bytes > kListBytesMax) break;
    --first;
  }
  list.DeleteSubrange(0, first);
  return static_cast<uint64_t>(first);
}

}  // namespace tessera
