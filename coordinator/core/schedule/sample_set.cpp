#include "coordinator/core/schedule/sample_set.h"

#include <algorithm>

namespace tessera {

void SampleSet::Add(Interval added) {
  // All that touch the new interval become one with it.
  const auto first = std::lower_bound(intervals_.begin(), intervals_.end(), added.begin,
                                      [](const Interval& each, uint32_t value) { return each.end < value; });
  auto last = first;
  while (last != intervals_.end() && last->begin <= added.end) {
    added.begin = std::min(added.begin, last->begin);
    added.end = std::max(added.end, last->end);
    ++last;
  }
  intervals_.insert(intervals_.erase(first, last), added);
}

void SampleSet::Remove(SampleRange range) {
  Remove(Interval{range.begin, range.end()});
}

void SampleSet::Remove(const SampleSet& other) {
  for (const Interval& each : other.intervals_) Remove(each);
}

void SampleSet::Remove(Interval removed) {
  std::vector<Interval> kept;
  kept.reserve(intervals_.size() + 1);
  for (const Interval& each : intervals_) {
    const Interval left{each.begin, std::min(each.end, removed.begin)};
    const Interval right{std::max(each.begin, removed.end), each.end};
    if (left.begin < left.end) kept.push_back(left);
    if (right.begin < right.end) kept.push_back(right);
  }
  intervals_ = std::move(kept);
}

// The only interval that may hold `sample` or what follows: the first that ends after it.
std::vector<SampleSet::Interval>::const_iterator SampleSet::EndingAfter(uint32_t sample) const {
  return std::upper_bound(intervals_.begin(), intervals_.end(), sample,
                          [](uint32_t value, const Interval& each) { return value < each.end; });
}

bool SampleSet::Contains(SampleRange range) const {
  const auto found = EndingAfter(range.begin);
  return found != intervals_.end() && found->begin <= range.begin && range.end() <= found->end;
}

bool SampleSet::Overlaps(SampleRange range) const {
  const auto found = EndingAfter(range.begin);
  return found != intervals_.end() && found->begin < range.end();
}

uint32_t SampleSet::Count() const {
  uint32_t count = 0;
  for (const Interval& each : intervals_) count += each.end - each.begin;
  return count;
}

}  // namespace tessera
