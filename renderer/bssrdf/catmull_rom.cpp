#include "renderer/bssrdf/catmull_rom.h"

#include <algorithm>
#include <cstddef>

namespace tessera {
namespace {

// The last i in [0, size - 2] with nodes[i] <= x.
size_t IntervalOf(std::span<const float> nodes, float x) {
  const auto above = std::upper_bound(nodes.begin(), nodes.end(), x);
  const auto i = static_cast<size_t>(above - nodes.begin());
  return std::clamp<size_t>(i, 1, nodes.size() - 1) - 1;
}

// One piece of a spline over t in [0, 1]: its ends and its slopes there per t.
struct Piece {
  float f0, f1, d0, d1;
};
Piece PieceAt(std::span<const float> nodes, std::span<const float> values, size_t i) {
  const float width = nodes[i + 1] - nodes[i];
  Piece piece{values[i], values[i + 1], values[i + 1] - values[i], values[i + 1] - values[i]};
  if (i > 0) piece.d0 = width * (values[i + 1] - values[i - 1]) / (nodes[i + 1] - nodes[i - 1]);
  if (i + 2 < nodes.size()) piece.d1 = width * (values[i + 2] - values[i]) / (nodes[i + 2] - nodes[i]);
  return piece;
}

float Evaluate(const Piece& p, float t) {
  const float t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * p.f0 + (3 * t2 - 2 * t3) * p.f1 + (t3 - 2 * t2 + t) * p.d0 +
         (t3 - t2) * p.d1;
}

}  // namespace

std::optional<SplineWeights> CatmullRomWeights(std::span<const float> nodes, float x) {
  if (!(x >= nodes.front() && x <= nodes.back())) return std::nullopt;
  const size_t i = IntervalOf(nodes, x);
  const float width = nodes[i + 1] - nodes[i];
  const float t = (x - nodes[i]) / width, t2 = t * t, t3 = t2 * t;
  SplineWeights result;
  result.offset = static_cast<int>(i) - 1;
  std::array<float, 4>& w = result.weights;
  w[1] = 2 * t3 - 3 * t2 + 1;
  w[2] = 3 * t2 - 2 * t3;
  // The slopes at both ends, from the neighbours, or one-sided at the ends of the table.
  const float slope0 = t3 - 2 * t2 + t, slope1 = t3 - t2;
  if (i > 0) {
    const float share = slope0 * width / (nodes[i + 1] - nodes[i - 1]);
    w[0] = -share;
    w[2] += share;
  } else {
    w[1] -= slope0;
    w[2] += slope0;
  }
  if (i + 2 < nodes.size()) {
    const float share = slope1 * width / (nodes[i + 2] - nodes[i]);
    w[1] -= share;
    w[3] = share;
  } else {
    w[1] -= slope1;
    w[2] += slope1;
  }
  return result;
}

float IntegrateCatmullRom(std::span<const float> nodes, std::span<const float> values,
                          std::span<float> before) {
  float sum = 0;
  before[0] = 0;
  for (size_t i = 0; i + 1 < nodes.size(); ++i) {
    const Piece p = PieceAt(nodes, values, i);
    sum += (nodes[i + 1] - nodes[i]) * ((p.f0 + p.f1) / 2 + (p.d0 - p.d1) / 12);
    before[i + 1] = sum;
  }
  return sum;
}

float InvertCatmullRom(std::span<const float> nodes, std::span<const float> values, float y) {
  if (!(y > values.front())) return nodes.front();
  if (!(y < values.back())) return nodes.back();
  const size_t i = IntervalOf(values, y);
  const Piece p = PieceAt(nodes, values, i);
  float low = 0, high = 1;
  for (int step = 0; step < 32; ++step) {
    const float middle = (low + high) / 2;
    (Evaluate(p, middle) < y ? low : high) = middle;
  }
  return nodes[i] + (low + high) / 2 * (nodes[i + 1] - nodes[i]);
}

}  // namespace tessera
