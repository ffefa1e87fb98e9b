// Piecewise constant densities on [0, 1) and [0, 1)^2, sampled by inverting their running sums: neighbouring
// random numbers give neighbouring samples, so that stratified ones stay stratified. A guide table bounds
// each search to a few steps. Immutable once built.
//
// The density that is reported is the one that the rounded running sums really have: where a cell's share is
// lost to rounding both its density and its samples are, so estimates stay unbiased.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/math/vec.h"

namespace tessera {

// A density with respect to length on [0, 1), constant in each of `size()` cells of equal width.
class Distribution1D {
 public:
  Distribution1D() = default;
  // Weights are finite and not negative, and there is at least one. If all are 0 the density is uniform.
  explicit Distribution1D(std::span<const float> weights);

  struct Drawn {
    float x = 0;    // in the cell
    float pdf = 0;  // density at x
    uint32_t cell = 0;
  };
  // u in [0, 1). The probability of a cell is Pmf(cell).
  Drawn Sample(float u) const;
  // The density at x; 0 outside [0, 1].
  float Pdf(float x) const;
  float Pmf(uint32_t cell) const { return cdf_[cell + 1] - cdf_[cell]; }
  // The u with which Sample finds x in [0, 1].
  float Invert(float x) const;
  // The mean of the weights.
  float mean() const { return mean_; }
  uint32_t size() const { return size_; }

 private:
  std::vector<float> cdf_;       // size + 1 values from 0 to 1, then padding
  std::vector<uint32_t> guide_;  // bucket b of equal width in u starts in cell guide_[b]
  uint32_t size_ = 0;
  float mean_ = 0;
};

// A density with respect to area on [0, 1)^2, constant in each cell of a grid. y chooses a row, x a cell in
// it.
class Distribution2D {
 public:
  Distribution2D() = default;
  // `weights` holds height rows of width values, as for Distribution1D.
  Distribution2D(std::span<const float> weights, uint32_t width, uint32_t height);

  struct Drawn {
    Point2 p;       // in the cell
    float pdf = 0;  // density at p
    uint32_t x = 0, y = 0;
  };
  // u in [0, 1)^2.
  Drawn Sample(Point2 u) const;
  // The density at p; 0 outside [0, 1]^2.
  float Pdf(Point2 p) const;
  // The density in a cell.
  float CellPdf(uint32_t x, uint32_t y) const;
  // The u with which Sample finds p in [0, 1]^2.
  Point2 Invert(Point2 p) const;
  // The mean of the weights.
  float mean() const { return rows_.mean(); }
  uint32_t width() const { return width_; }
  uint32_t height() const { return rows_.size(); }
  size_t bytes() const;

 private:
  Distribution1D rows_;
  std::vector<float> cdf_;       // width + 1 values for each row, then padding
  std::vector<uint32_t> guide_;  // guide_size_ + 1 values for each row
  uint32_t width_ = 0, guide_size_ = 0;
};

}  // namespace tessera
