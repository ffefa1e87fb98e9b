// A set of sample indices of one pixel or tile, as disjoint intervals in order.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/film/sample_range.h"

namespace tessera {

class SampleSet {
 public:
  struct Interval {
    uint32_t begin, end;
    bool operator==(const Interval&) const = default;
  };

  void Add(SampleRange range) { Add(Interval{range.begin, range.end()}); }
  void Remove(SampleRange range);
  void Remove(const SampleSet& other);
  void Remove(Interval removed);
  bool Contains(SampleRange range) const;
  bool Overlaps(SampleRange range) const;
  bool empty() const { return intervals_.empty(); }
  // The number of samples.
  uint32_t Count() const;
  // The set must not be empty.
  Interval First() const { return intervals_.front(); }
  const std::vector<Interval>& intervals() const { return intervals_; }

  bool operator==(const SampleSet&) const = default;

  void Add(Interval added);

 private:
  std::vector<Interval>::const_iterator EndingAfter(uint32_t sample) const;
  std::vector<Interval> intervals_;  // in order, neither touching nor empty
};

}  // namespace tessera
