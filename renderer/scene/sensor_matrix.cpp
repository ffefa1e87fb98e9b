#include "renderer/scene/sensor_matrix.h"

#include <cmath>

#include "renderer/color/named_spectra.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

using Components = std::array<double, 3>;
using ComponentMatrix = std::array<Components, 3>;

double Integral(const DenseTable& a, const DenseTable& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return sum;
}

// What three responses give for a reflectance, where the second one gives 1 for a reflectance of 1.
Components Project(const DenseTable& reflectance, const DenseTable& illuminant,
                   const std::array<const DenseTable*, 3>& responses) {
  Components sums{};
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = 0; i < reflectance.size(); ++i) {
      sums[c] += static_cast<double>((*responses[c])[i]) * static_cast<double>(reflectance[i]) *
                 static_cast<double>(illuminant[i]);
    }
  }
  const double white = Integral(*responses[1], illuminant);
  for (double& sum : sums) sum /= white;
  return sums;
}

ComponentMatrix Inverse(const ComponentMatrix& m) {
  const auto cofactor = [&](size_t row, size_t column) {
    const size_t r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
    return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
  };
  const double determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
  TESSERA_CHECK(std::abs(determinant) > 0);  // the responses of sensors are independent of each other
  ComponentMatrix inverse{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) inverse[j][i] = cofactor(i, j) / determinant;
  }
  return inverse;
}

}  // namespace

Matrix3 XyzFromSensor(const std::array<const DenseTable*, 3>& responses, const DenseTable& illuminant,
                      const DenseTable& output_illuminant) {
  const std::array<const DenseTable*, 3> observer{&CieX(), &CieY(), &CieZ()};
  const double white = Integral(CieY(), illuminant) / Integral(*responses[1], illuminant);
  // The normal equations of xyz = matrix x sensor.
  ComponentMatrix sensor_sensor{}, sensor_xyz{};
  for (const DenseTable& patch : ColorCheckerPatches()) {
    const Components sensor = Project(patch, illuminant, responses);
    const Components xyz = Project(patch, output_illuminant, observer);
    for (size_t i = 0; i < 3; ++i) {
      for (size_t j = 0; j < 3; ++j) {
        sensor_sensor[i][j] += sensor[i] * sensor[j];
        sensor_xyz[i][j] += sensor[i] * xyz[j] * white;
      }
    }
  }
  const ComponentMatrix inverse = Inverse(sensor_sensor);
  Matrix3 matrix{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      double sum = 0;
      for (size_t k = 0; k < 3; ++k) sum += inverse[i][k] * sensor_xyz[k][j];
      matrix[j][i] = static_cast<float>(sum);
    }
  }
  return matrix;
}

}  // namespace tessera
