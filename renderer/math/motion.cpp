#include "renderer/math/motion.h"

#include <cmath>

#include "renderer/math/flat_transform.h"

namespace tessera {
namespace {

using Matrix3 = std::array<std::array<double, 3>, 3>;

constexpr int kPolarStepsMax = 100;         // it converges quadratically: 10 do for any scene
constexpr double kPolarTolerance = 1e-12;   // of an element of the rotation
constexpr float kParallelCosine = 0.9995f;  // quaternions nearer than this are mixed straight

double Determinant(const Matrix3& a) {
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
         a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
         a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

// The transposed inverse: the matrix of cofactors over the determinant.
Matrix3 InverseTranspose(const Matrix3& a) {
  const double scale = 1 / Determinant(a);
  Matrix3 r;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      r[i][j] = (a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1]) * scale;
    }
  }
  return r;
}

// w + xi + yj + zk
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
};

double Dot(const Quaternion& a, const Quaternion& b) {
  return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}

// Shoemake 1991, "Quaternions and 4x4 matrices".
Quaternion FromRotation(const Matrix3& m) {
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (trace > 0) {
    const double s = std::sqrt(trace + 1), t = 0.5 / s;
    return {s / 2, (m[2][1] - m[1][2]) * t, (m[0][2] - m[2][0]) * t, (m[1][0] - m[0][1]) * t};
  }
  int i = m[1][1] > m[0][0] ? 1 : 0;
  if (m[2][2] > m[i][i]) i = 2;
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  const double s = std::sqrt(std::max(m[i][i] - m[j][j] - m[k][k] + 1, 0.0));
  const double t = s > 0 ? 0.5 / s : 0;
  double v[3];
  v[i] = s / 2;
  v[j] = (m[j][i] + m[i][j]) * t;
  v[k] = (m[k][i] + m[i][k]) * t;
  return {(m[k][j] - m[j][k]) * t, v[0], v[1], v[2]};
}

Matrix3 ToRotation(const Quaternion& q) {
  return {{{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.w * q.z), 2 * (q.x * q.z + q.w * q.y)},
           {2 * (q.x * q.y + q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.w * q.x)},
           {2 * (q.x * q.z - q.w * q.y), 2 * (q.y * q.z + q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)}}};
}

Quaternion Slerp(const Quaternion& a, Quaternion b, float s) {
  if (Dot(a, b) < 0) b = {-b.w, -b.x, -b.y, -b.z};
  const float cosine = std::min(static_cast<float>(Dot(a, b)), 1.0f);
  double from = 1 - s, to = s;
  if (cosine < kParallelCosine) {  // sines of floats: those of doubles are not the same on all machines
    const float angle = std::acos(cosine);
    from = std::sin((1 - s) * angle);
    to = std::sin(s * angle);
  }
  const Quaternion q{from * a.w + to * b.w, from * a.x + to * b.x, from * a.y + to * b.y,
                     from * a.z + to * b.z};
  const double length = std::sqrt(Dot(q, q));
  return {q.w / length, q.x / length, q.y / length, q.z / length};
}

// Translation after rotation after stretch.
struct Parts {
  double translation[3];
  Quaternion rotation;
  Matrix3 stretch;
};

Parts Decompose(const Transform& transform) {
  Parts parts;
  Matrix3 m;
  for (int i = 0; i < 3; ++i) {
    parts.translation[i] = transform.matrix().m[i][3];
    for (int j = 0; j < 3; ++j) m[i][j] = transform.matrix().m[i][j];
  }
  Matrix3 rotation = m;
  double change = 1;
  for (int step = 0; step < kPolarStepsMax && change > kPolarTolerance; ++step) {
    const Matrix3 other = InverseTranspose(rotation);
    change = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const double next = (rotation[i][j] + other[i][j]) / 2;
        change = std::max(change, std::abs(next - rotation[i][j]));
        rotation[i][j] = next;
      }
    }
  }
  if (Determinant(rotation) < 0) {  // a mirror image: the stretch does the mirroring
    for (auto& row : rotation) {
      for (double& v : row) v = -v;
    }
  }
  for (int i = 0; i < 3; ++i) {  // rotation^-1 m
    for (int j = 0; j < 3; ++j) {
      parts.stretch[i][j] = rotation[0][i] * m[0][j] + rotation[1][i] * m[1][j] + rotation[2][i] * m[2][j];
    }
  }
  parts.rotation = FromRotation(rotation);
  return parts;
}

// Element by element.
Matrix4 Straight(const Matrix4& a, const Matrix4& b, float s) {
  Matrix4 m;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) m.m[i][j] = (1 - s) * a.m[i][j] + s * b.m[i][j];
  }
  return m;
}

}  // namespace

std::optional<Transform> Interpolate(const Transform& start, const Transform& end, float s) {
  if (s <= 0 || start == end) return start;
  if (s >= 1) return end;
  // A flat map has no rotation: what grows from nothing or shrinks to it does so in a straight way.
  if (IsFlat(start) || IsFlat(end)) return Transform::FromMatrix(Straight(start.matrix(), end.matrix(), s));
  const Parts a = Decompose(start), b = Decompose(end);
  const Matrix3 rotation = ToRotation(Slerp(a.rotation, b.rotation, s));
  const double from = 1 - s, to = s;
  Matrix4 m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += rotation[i][k] * (from * a.stretch[k][j] + to * b.stretch[k][j]);
      m.m[i][j] = static_cast<float>(sum);
    }
    m.m[i][3] = static_cast<float>(from * a.translation[i] + to * b.translation[i]);
  }
  return Transform::FromMatrix(m);
}

}  // namespace tessera
