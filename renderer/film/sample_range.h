// Dyadic ranges of sample indices: the nodes of the fixed binary tree over which every pixel's samples are
// summed.
#pragma once

#include <bit>
#include <compare>
#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

// Of one frame: more than any render needs, and indices fit into 32 bits.
constexpr uint32_t kSamplesPerPixelMax = 1u << 20;

// Samples [begin, begin + size): size is a power of two and begin a multiple of it.
struct SampleRange {
  uint32_t begin = 0;
  uint32_t size = 0;

  auto operator<=>(const SampleRange&) const = default;
  uint32_t end() const { return begin + size; }
  bool Contains(SampleRange other) const { return begin <= other.begin && other.end() <= end(); }
  bool Overlaps(SampleRange other) const { return begin < other.end() && other.begin < end(); }
  // Whether this is a node of the tree within the limit on samples.
  bool IsDyadic() const {
    return size > 0 && std::has_single_bit(size) && begin % size == 0 && begin <= kSamplesPerPixelMax &&
           size <= kSamplesPerPixelMax && end() <= kSamplesPerPixelMax;
  }
  SampleRange Left() const { return {begin, size / 2}; }
  SampleRange Right() const { return {begin + size / 2, size / 2}; }
  SampleRange Parent() const { return {begin & ~size, size * 2}; }
  // The other half of the parent.
  SampleRange Sibling() const { return {begin ^ size, size}; }
  bool IsLeft() const { return (begin & size) == 0; }
  std::string Text() const;  // "[begin,end)"
};

// The size of the largest dyadic range that starts at `begin` and ends at `end` or before; begin < end.
uint32_t DyadicSizeMax(uint32_t begin, uint32_t end);

// [0, samples) as its largest dyadic ranges, in order: the terms of a finished pixel's sum.
std::vector<SampleRange> DyadicPartition(uint32_t samples);

}  // namespace tessera
