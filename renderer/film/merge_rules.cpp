#include "renderer/film/merge_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace tessera {
namespace {

uint32_t Bits(float id) {
  return std::bit_cast<uint32_t>(id);
}

// Drops the ids of least weight until at most kIdsPerPixelMax are left.
void DropLeast(IdSet& set) {
  if (set.size() <= kIdsPerPixelMax) return;
  IdSet by_weight = set;
  std::ranges::sort(by_weight, [](const IdWeight& a, const IdWeight& b) {
    const float weight_a = std::abs(a.weight), weight_b = std::abs(b.weight);
    return weight_a != weight_b ? weight_a > weight_b : Bits(a.id) < Bits(b.id);
  });
  by_weight.resize(kIdsPerPixelMax);
  std::erase_if(set, [&](const IdWeight& each) {
    return std::ranges::find(by_weight, Bits(each.id), [](const IdWeight& kept) { return Bits(kept.id); }) ==
           by_weight.end();
  });
}

void Append(const IdSet& set, std::vector<float>& entries) {
  for (const IdWeight& each : set) {
    entries.push_back(each.id);
    entries.push_back(each.weight);
  }
}

Result<void> CheckIds(std::span<const float> entries) {
  for (size_t i = 0; i < entries.size(); i += 2) {
    if (!std::isfinite(entries[i]) || entries[i] == 0) return Failed("an id is zero or not finite");
    if (i > 0 && Bits(entries[i - 2]) >= Bits(entries[i])) return Failed("ids are not in order");
  }
  return {};
}

}  // namespace

void MergeIds(std::span<const IdWeight> left, std::span<const IdWeight> right, IdSet& merged) {
  merged.clear();
  auto l = left.begin();
  auto r = right.begin();
  while (l != left.end() || r != right.end()) {
    if (r == right.end() || (l != left.end() && Bits(l->id) < Bits(r->id))) {
      merged.push_back(*l++);
    } else if (l == left.end() || Bits(r->id) < Bits(l->id)) {
      merged.push_back(*r++);
    } else {
      merged.push_back({l->id, l->weight + r->weight});
      ++l;
      ++r;
    }
  }
  DropLeast(merged);
}

void MergeSiblings(const PixelShape& shape, size_t pixels, const std::vector<float>& left,
                   const std::vector<float>& right, std::vector<float>& parent) {
  if (shape.HasOnlySums()) {
    for (size_t i = 0; i < parent.size(); ++i) parent[i] = left[i] + right[i];
    return;
  }
  const size_t stride = shape.stride();
  std::vector<float> merged(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(pixels * stride));
  IdReader left_ids(shape, pixels, left), right_ids(shape, pixels, right);
  IdSet set;
  std::vector<float> entries;
  for (size_t p = 0; p < pixels; ++p) {
    float* const record = &merged[p * stride];
    const float* const other = &right[p * stride];
    MergeRecord(shape, record, other);
    for (size_t slot = stride - shape.id_sets; slot < stride; ++slot) {
      MergeIds(left_ids.Next(record[slot]), right_ids.Next(other[slot]), set);
      record[slot] = static_cast<float>(set.size());
      Append(set, entries);
    }
  }
  merged.insert(merged.end(), entries.begin(), entries.end());
  parent = std::move(merged);
}

bool AreInRange(const PixelShape& shape, size_t pixels, std::span<const float> values, uint32_t samples) {
  const float sum_max = kSampleValueMax * static_cast<float>(samples);
  const auto is_sum = [&](float value) { return std::abs(value) <= sum_max; };
  if (std::ranges::all_of(values, is_sum)) return true;
  const size_t stride = shape.stride();
  for (size_t i = 0; i < values.size(); ++i) {
    const bool is_record = i < pixels * stride;
    // After the records follow ids, which are any floats, each with its weight.
    const bool is_added = is_record ? i % stride < shape.sums : (i - pixels * stride) % 2 == 1;
    if (is_added ? !is_sum(values[i]) : !std::isfinite(values[i])) return false;
  }
  return true;
}

Result<void> CheckValues(const PixelShape& shape, size_t pixels, std::span<const float> values) {
  const size_t stride = shape.stride();
  if (values.size() < pixels * stride || (shape.id_sets == 0 && values.size() > pixels * stride)) {
    return Failed(
        fmt::format("{} values instead of {} for each of {} pixels", values.size(), stride, pixels));
  }
  if (shape.HasOnlySums()) return {};
  std::span<const float> entries = values.subspan(pixels * stride);
  for (size_t p = 0; p < pixels; ++p) {
    const float* record = &values[p * stride];
    if (shape.nearest > 0 && !(record[shape.sums] >= 0)) return Failed("a depth is negative");
    for (size_t slot = size_t{shape.sums} + shape.nearest; slot < stride; ++slot) {
      const float size = record[slot];
      if (!(size >= 0 && size <= static_cast<float>(kIdsPerPixelMax) && size == std::floor(size)) ||
          2 * static_cast<size_t>(size) > entries.size()) {
        return Failed("the size of a set of ids is wrong");
      }
      const size_t floats = 2 * static_cast<size_t>(size);
      if (auto ok = CheckIds(entries.first(floats)); !ok) return ok;
      entries = entries.subspan(floats);
    }
  }
  if (!entries.empty()) return Failed("there are more ids than the pixels have");
  return {};
}

void KeepPixels(const PixelShape& shape, size_t pixels, const PixelMask& kept, std::vector<float>& values) {
  if (kept.HasAll()) return;
  const size_t stride = shape.stride();
  IdReader ids(shape, pixels, values);
  std::vector<float> entries;
  for (size_t p = 0; p < pixels; ++p) {
    float* const record = &values[p * stride];
    for (size_t slot = stride - shape.id_sets; slot < stride; ++slot) {
      const IdSet set = ids.Next(record[slot]);
      if (kept.Has(p)) Append(set, entries);
    }
    if (!kept.Has(p)) std::fill_n(record, stride, 0.0f);
  }
  if (shape.id_sets == 0) return;
  values.resize(pixels * stride);
  values.insert(values.end(), entries.begin(), entries.end());
}

}  // namespace tessera
