#include "renderer/math/motion.h"

#include <algorithm>
#include <cmath>

#include "renderer/math/flat_transform.h"

namespace tessera {
namespace {

using Rows3 = std::array<std::array<double, 3>, 3>;

constexpr int kPolarStepsMax = 100;         // it converges quadratically: 10 do for any scene
constexpr double kPolarTolerance = 1e-12;   // of an element of the rotation
constexpr float kParallelCosine = 0.9995f;  // quaternions nearer than this are mixed straight

double Determinant(const Rows3& a) {
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
         a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
         a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

// The transposed inverse: the matrix of cofactors over the determinant.
Rows3 InverseTranspose(const Rows3& a) {
  const double scale = 1 / Determinant(a);
  Rows3 r;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      r[i][j] = (a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1]) * scale;
    }
  }
  return r;
}

// Element by element.
Matrix4 Straight(const Matrix4& a, const Matrix4& b, float s) {
  Matrix4 m;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) m.m[i][j] = (1 - s) * a.m[i][j] + s * b.m[i][j];
  }
  return m;
}

double LengthOf(const double (&v)[3]) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// The length of the longest vector that `m` makes of a corner of the box, and so of any of its points.
double ReachOf(const Rows3& m, const Bounds3& box) {
  double reach = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const double p[3] = {corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                         corner & 4 ? box.max.z : box.min.z};
    double v[3];
    for (int i = 0; i < 3; ++i) v[i] = m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2];
    reach = std::max(reach, LengthOf(v));
  }
  return reach;
}

}  // namespace

// Shoemake 1991, "Quaternions and 4x4 matrices".
TransformPath::Quaternion TransformPath::FromRotation(const Matrix3& m) {
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

TransformPath::Matrix3 TransformPath::ToRotation(const Quaternion& q) {
  return {{{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.w * q.z), 2 * (q.x * q.z + q.w * q.y)},
           {2 * (q.x * q.y + q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.w * q.x)},
           {2 * (q.x * q.z - q.w * q.y), 2 * (q.y * q.z + q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)}}};
}

TransformPath::Parts TransformPath::Decompose(const Transform& transform) {
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

TransformPath::TransformPath(const Transform& start, const Transform& end) : start_(start), end_(end) {
  is_straight_ = IsFlat(start) || IsFlat(end);
  if (is_straight_) return;
  from_ = Decompose(start);
  to_ = Decompose(end);
  const Quaternion& a = from_.rotation;
  Quaternion& b = to_.rotation;
  double dot = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  if (dot < 0) {
    b = {-b.w, -b.x, -b.y, -b.z};
    dot = -dot;
  }
  cosine_ = std::min(static_cast<float>(dot), 1.0f);
  // Of a float: functions of doubles do not have the same bits on all machines.
  angle_ = std::acos(cosine_);
}

TransformPath::Quaternion TransformPath::RotationAt(float s) const {
  const Quaternion &a = from_.rotation, &b = to_.rotation;
  double from = 1 - s, to = s;
  if (cosine_ < kParallelCosine) {
    from = std::sin((1 - s) * angle_);
    to = std::sin(s * angle_);
  }
  const Quaternion q{from * a.w + to * b.w, from * a.x + to * b.x, from * a.y + to * b.y,
                     from * a.z + to * b.z};
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / length, q.x / length, q.y / length, q.z / length};
}

Matrix4 TransformPath::MatrixAt(float s) const {
  if (is_straight_) return Straight(start_.matrix(), end_.matrix(), s);
  const Matrix3 rotation = ToRotation(RotationAt(s));
  const double from = 1 - s, to = s;
  Matrix4 m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double sum = 0;
      for (int k = 0; k < 3; ++k)
        sum += rotation[i][k] * (from * from_.stretch[k][j] + to * to_.stretch[k][j]);
      m.m[i][j] = static_cast<float>(sum);
    }
    m.m[i][3] = static_cast<float>(from * from_.translation[i] + to * to_.translation[i]);
  }
  return m;
}

std::optional<Transform> TransformPath::At(float s) const {
  if (s <= 0) return start_;
  if (s >= 1) return end_;
  const Matrix4 matrix = MatrixAt(s);
  const std::optional<Matrix4> inverse = AffineInverse(matrix);
  if (!inverse) return std::nullopt;
  return Transform(matrix, *inverse);
}

// A point is R(s) S(s) p + T(s), with S and T linear and a rotation at speed w: |R'| <= w and |R''| <= w^2,
// so the second derivative is at most w^2 |S p| + 2 w |S' p|.
double TransformPath::AccelerationMax(const Bounds3& box) const {
  const double speed = 2 * static_cast<double>(angle_);
  Matrix3 change;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) change[i][j] = to_.stretch[i][j] - from_.stretch[i][j];
  }
  const double reach = std::max(ReachOf(from_.stretch, box), ReachOf(to_.stretch, box));
  return speed * speed * reach + 2 * speed * ReachOf(change, box);
}

// Between two places at a distance h of a path, a point is within h^2 / 8 of the largest second derivative of
// the straight line between them.
Bounds3 TransformPath::BoundsOf(const Bounds3& box, float from, float to) const {
  // Of a path that turns. Half a turn in 32 steps is a 800th of the radius off.
  constexpr int kSteps = 32;
  // Quaternions that are mixed straight do not turn at quite constant speed.
  constexpr double kUneven = 1.1;
  // Relative to the coordinates: more than the rounding errors of a map and its inverse together.
  constexpr float kRounding = 4e-6f;
  const bool turns = !is_straight_ && angle_ > 0;
  const int steps = turns && to > from ? kSteps : 1;
  Bounds3 bounds;
  for (int i = 0; i <= steps; ++i) {
    const float s = from + (to - from) * (static_cast<float>(i) / static_cast<float>(steps));
    bounds.Add(Transform(MatrixAt(s), ZeroMatrix()).ToBounds(box));
  }
  // The ends are maps of their own, which differ from the composed ones by rounding errors.
  if (from <= 0) bounds.Add(start_.ToBounds(box));
  if (to >= 1) bounds.Add(end_.ToBounds(box));
  const double step = static_cast<double>(to - from) / steps;
  const float bulge = turns ? static_cast<float>(kUneven * AccelerationMax(box) * step * step / 8) : 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float reach = std::max(std::abs(bounds.min[axis]), std::abs(bounds.max[axis]));
    const float slack = bulge + kRounding * reach;
    bounds.min[axis] -= slack;
    bounds.max[axis] += slack;
  }
  return bounds;
}

std::optional<Transform> Interpolate(const Transform& start, const Transform& end, float s) {
  if (start == end) return start;
  return TransformPath(start, end).At(s);
}

}  // namespace tessera
