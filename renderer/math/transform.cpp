#include "renderer/math/transform.h"

#include <cmath>
#include <utility>

namespace tessera {

Matrix4 operator*(const Matrix4& a, const Matrix4& b) {
  Matrix4 r;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      // double: a chain of transforms loses no more than the last rounding to float
      double sum = 0;
      for (int k = 0; k < 4; ++k) sum += static_cast<double>(a.m[i][k]) * b.m[k][j];
      r.m[i][j] = static_cast<float>(sum);
    }
  }
  return r;
}

Matrix4 Transpose(const Matrix4& a) {
  Matrix4 r;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) r.m[i][j] = a.m[j][i];
  }
  return r;
}

// Gauss-Jordan elimination with partial pivoting, in double.
std::optional<Matrix4> Inverse(const Matrix4& a) {
  double w[4][8];
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      w[i][j] = a.m[i][j];
      w[i][j + 4] = i == j ? 1 : 0;
    }
  }
  for (int column = 0; column < 4; ++column) {
    int pivot = column;
    for (int row = column + 1; row < 4; ++row) {
      if (std::abs(w[row][column]) > std::abs(w[pivot][column])) pivot = row;
    }
    if (!(std::abs(w[pivot][column]) > 0) || !std::isfinite(w[pivot][column])) return std::nullopt;
    for (int j = 0; j < 8; ++j) std::swap(w[pivot][j], w[column][j]);
    const double scale = 1 / w[column][column];
    for (double& v : w[column]) v *= scale;
    for (int row = 0; row < 4; ++row) {
      if (row == column) continue;
      const double factor = w[row][column];
      for (int j = 0; j < 8; ++j) w[row][j] -= factor * w[column][j];
    }
  }
  Matrix4 r;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      r.m[i][j] = static_cast<float>(w[i][j + 4]);
      if (!std::isfinite(r.m[i][j])) return std::nullopt;
    }
  }
  return r;
}

// The transposed cofactors of the linear part over its determinant, in double.
std::optional<Matrix4> AffineInverse(const Matrix4& a) {
  double w[3][3], cofactors[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) w[i][j] = a.m[i][j];
  }
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      cofactors[i][j] = w[i1][j1] * w[i2][j2] - w[i1][j2] * w[i2][j1];
    }
  }
  const double determinant =
      w[0][0] * cofactors[0][0] + w[0][1] * cofactors[0][1] + w[0][2] * cofactors[0][2];
  if (determinant == 0) return std::nullopt;
  const double scale = 1 / determinant;
  Matrix4 r;
  for (int i = 0; i < 3; ++i) {
    double translation = 0;
    for (int j = 0; j < 3; ++j) {
      const double element = cofactors[j][i] * scale;
      r.m[i][j] = static_cast<float>(element);
      translation -= element * a.m[j][3];
    }
    r.m[i][3] = static_cast<float>(translation);
    for (const float v : r.m[i]) {
      if (!std::isfinite(v)) return std::nullopt;
    }
  }
  return r;
}

float Determinant(const Matrix4& a) {
  double w[4][4];
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) w[i][j] = a.m[i][j];
  }
  double determinant = 1;
  for (int column = 0; column < 4; ++column) {
    int pivot = column;
    for (int row = column + 1; row < 4; ++row) {
      if (std::abs(w[row][column]) > std::abs(w[pivot][column])) pivot = row;
    }
    if (w[pivot][column] == 0) return 0;
    if (pivot != column) {
      std::swap(w[pivot], w[column]);
      determinant = -determinant;
    }
    determinant *= w[column][column];
    for (int row = column + 1; row < 4; ++row) {
      const double factor = w[row][column] / w[column][column];
      for (int j = column; j < 4; ++j) w[row][j] -= factor * w[column][j];
    }
  }
  return static_cast<float>(determinant);
}

std::optional<Transform> Transform::FromMatrix(const Matrix4& matrix) {
  const std::optional<Matrix4> inverse = tessera::Inverse(matrix);
  if (!inverse) return std::nullopt;
  return Transform(matrix, *inverse);
}

bool Transform::SwapsHandedness() const {
  double m[3][3];  // double: the product of three small scales does not underflow
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m[i][j] = m_.m[i][j];
  }
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return determinant < 0;
}

bool Transform::KeepsAngles() const {
  constexpr double kTolerance = 1e-5;  // relative, of the squared scale and of orthogonality
  const auto product = [this](int a, int b) {
    double sum = 0;
    for (int row = 0; row < 3; ++row) sum += static_cast<double>(m_.m[row][a]) * m_.m[row][b];
    return sum;
  };
  const double scale = product(0, 0);
  const auto is_small = [&](double error) { return std::abs(error) <= kTolerance * scale; };
  return is_small(product(1, 1) - scale) && is_small(product(2, 2) - scale) && is_small(product(0, 1)) &&
         is_small(product(1, 2)) && is_small(product(2, 0));
}

Point3 Transform::ToPoint(Point3 p) const {
  const auto& m = m_.m;
  const Point3 r{m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
                 m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
                 m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]};
  const float w = m[3][0] * p.x + m[3][1] * p.y + m[3][2] * p.z + m[3][3];
  return w == 1 ? r : r / w;
}

Vec3 Transform::ToVector(Vec3 v) const {
  const auto& m = m_.m;
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

Normal3 Transform::ToNormal(Normal3 n) const {
  const auto& m = inverse_.m;
  return {m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z, m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
          m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z};
}

Bounds3 Transform::ToBounds(const Bounds3& b) const {
  Bounds3 r;
  for (int corner = 0; corner < 8; ++corner) {
    r.Add(ToPoint(
        {corner & 1 ? b.max.x : b.min.x, corner & 2 ? b.max.y : b.min.y, corner & 4 ? b.max.z : b.min.z}));
  }
  return r;
}

Transform operator*(const Transform& a, const Transform& b) {
  return {a.matrix() * b.matrix(), b.inverse_matrix() * a.inverse_matrix()};
}

Transform Translate(Vec3 d) {
  Matrix4 m, inverse;
  for (int i = 0; i < 3; ++i) {
    m.m[i][3] = d[i];
    inverse.m[i][3] = -d[i];
  }
  return {m, inverse};
}

Transform Scale(float x, float y, float z) {
  Matrix4 m, inverse;
  const Vec3 factors{x, y, z};
  for (int i = 0; i < 3; ++i) {
    m.m[i][i] = factors[i];
    inverse.m[i][i] = 1 / factors[i];
  }
  return {m, inverse};
}

Transform Rotate(float degrees, Vec3 axis) {
  const Vec3 a = Normalize(axis);
  const float s = std::sin(Radians(degrees));
  const float c = std::cos(Radians(degrees));
  Matrix4 m;
  const float along[3] = {a.x, a.y, a.z};
  const float cross[3][3] = {{0, -a.z, a.y}, {a.z, 0, -a.x}, {-a.y, a.x, 0}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      m.m[i][j] = along[i] * along[j] * (1 - c) + (i == j ? c : 0) + cross[i][j] * s;
    }
  }
  return {m, Transpose(m)};
}

std::optional<Transform> LookAt(Point3 eye, Point3 look, Vec3 up) {
  if (eye == look || IsZero(up)) return std::nullopt;
  const Vec3 forward = Normalize(look - eye);
  const Vec3 side = Cross(Normalize(up), forward);
  if (Length(side) == 0) return std::nullopt;
  const Vec3 right = Normalize(side);
  const Vec3 new_up = Cross(forward, right);
  Matrix4 world_from_camera;
  for (int i = 0; i < 3; ++i) {
    world_from_camera.m[i][0] = right[i];
    world_from_camera.m[i][1] = new_up[i];
    world_from_camera.m[i][2] = forward[i];
    world_from_camera.m[i][3] = eye[i];
  }
  const std::optional<Transform> transform = Transform::FromMatrix(world_from_camera);
  if (!transform) return std::nullopt;
  return transform->Inverse();
}

Transform Perspective(float fov_degrees, float near, float far) {
  Matrix4 m;
  m.m = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, far / (far - near), -far * near / (far - near)}, {0, 0, 1, 0}}};
  const float inverse_tangent = 1 / std::tan(Radians(fov_degrees) / 2);
  const Transform scale = Scale(inverse_tangent, inverse_tangent, 1);
  const std::optional<Transform> projection = Transform::FromMatrix(m);
  return projection ? scale * *projection : scale;
}

}  // namespace tessera
