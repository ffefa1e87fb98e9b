// Values of pixels, as the filters read them.
#pragma once

#include <cstddef>
#include <vector>

namespace tessera {

// Values of pixels of some rows and columns, row by row.
class Plane {
 public:
  void Resize(int x0, int width, int y0, int height) {
    x0_ = x0;
    y0_ = y0;
    width_ = static_cast<size_t>(width);
    values_.resize(width_ * static_cast<size_t>(height));
  }
  // The address of pixel (x, y) in the coordinates of the picture; the others of its row follow.
  float* At(int x, int y) { return &values_[Index(x, y)]; }
  const float* At(int x, int y) const { return &values_[Index(x, y)]; }

 private:
  size_t Index(int x, int y) const {
    return static_cast<size_t>(y - y0_) * width_ + static_cast<size_t>(x - x0_);
  }

  int x0_ = 0, y0_ = 0;
  size_t width_ = 0;
  std::vector<float> values_;
};

// Of the Gaussian of SmoothSquaredDifferences.
constexpr int kSmoothRadius = 3;

// The pixel that is seen at `i` if the picture of `size` pixels is between mirrors.
int Mirrored(int i, int size);

// Copies the mirror image of row y, of `width` pixels, beside it, `margin` pixels at both ends.
void MirrorRow(Plane& plane, int y, int width, int margin);

// Stores in row y of `to`, of `width` pixels, `scale` times the squared difference of a and b, averaged over
// the pixels around with the weights of a Gaussian. a and b have kSmoothRadius pixels around the row.
void SmoothSquaredDifferences(const Plane& a, const Plane& b, int y, int width, float scale, Plane& to);

}  // namespace tessera
