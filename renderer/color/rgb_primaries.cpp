#include "renderer/color/rgb_primaries.h"

#include "renderer/color/named_spectra.h"

namespace tessera {
namespace {

std::array<double, 3> Multiply(const Matrix3d& m, const std::array<double, 3>& v) {
  std::array<double, 3> product{};
  for (size_t i = 0; i < 3; ++i) product[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return product;
}

std::array<double, 3> XyzOfPrimary(Chromaticity c) {
  return {c.x / c.y, 1, (1 - c.x - c.y) / c.y};
}

}  // namespace

std::array<double, 3> XyzOf(const DenseTable& spectrum) {
  double x = 0, y = 0, z = 0;
  for (size_t i = 0; i < spectrum.size(); ++i) {
    const double value = static_cast<double>(spectrum[i]);
    x += static_cast<double>(CieX()[i]) * value;
    y += static_cast<double>(CieY()[i]) * value;
    z += static_cast<double>(CieZ()[i]) * value;
  }
  constexpr double kNorm = static_cast<double>(kCieYIntegral);
  return {x / kNorm, y / kNorm, z / kNorm};
}

Matrix3d Inverse(const Matrix3d& m) {
  const auto cofactor = [&](size_t row, size_t column) {
    const size_t r0 = (row + 1) % 3, r1 = (row + 2) % 3, c0 = (column + 1) % 3, c1 = (column + 2) % 3;
    return m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
  };
  const double determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
  Matrix3d inverse{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) inverse[i][j] = cofactor(j, i) / determinant;
  }
  return inverse;
}

Matrix3d XyzFromRgb(const RgbPrimaries& primaries) {
  const std::array<double, 3> columns[] = {XyzOfPrimary(primaries.red), XyzOfPrimary(primaries.green),
                                           XyzOfPrimary(primaries.blue)};
  Matrix3d matrix{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) matrix[i][j] = columns[j][i];
  }
  const std::array<double, 3> scale = Multiply(Inverse(matrix), XyzOf(*NamedSpectrum(primaries.white)));
  for (auto& row : matrix) {
    for (size_t j = 0; j < 3; ++j) row[j] *= scale[j];
  }
  return matrix;
}

}  // namespace tessera
