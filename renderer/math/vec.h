// Two- and three-component vectors of floats. One type serves points, vectors and normals; the aliases say
// which is meant, and Transform (transform.h) has one function for each.
#pragma once

#include <algorithm>
#include <cmath>

namespace tessera {

constexpr float kPi = 3.14159265358979323846f;
constexpr float kInvPi = 0.31830988618379067154f;
constexpr float kInv2Pi = 0.15915494309189533577f;
constexpr float kInv4Pi = 0.07957747154594766788f;

inline float Radians(float degrees) {
  return degrees * (kPi / 180.0f);
}
inline float Lerp(float t, float a, float b) {
  return (1 - t) * a + t * b;
}
inline float Sqr(float v) {
  return v * v;
}
// Square root that takes a rounding error below zero for zero.
inline float SafeSqrt(float v) {
  return std::sqrt(std::max(0.0f, v));
}
// a*b - c*d with an error of 1.5 ulp (Kahan; Jeannerod et al. 2013): no cancellation in cross products.
inline float DifferenceOfProducts(float a, float b, float c, float d) {
  const float cd = c * d;
  const float difference = std::fma(a, b, -cd);
  const float error = std::fma(-c, d, cd);
  return difference + error;
}

struct Vec2 {
  float x = 0, y = 0;
  bool operator==(const Vec2&) const = default;
};
using Point2 = Vec2;

inline Vec2 operator+(Vec2 a, Vec2 b) {
  return {a.x + b.x, a.y + b.y};
}
inline Vec2 operator-(Vec2 a, Vec2 b) {
  return {a.x - b.x, a.y - b.y};
}
inline Vec2 operator*(Vec2 a, float s) {
  return {a.x * s, a.y * s};
}
inline Vec2 operator*(float s, Vec2 a) {
  return a * s;
}

struct Vec3 {
  float x = 0, y = 0, z = 0;
  bool operator==(const Vec3&) const = default;
  float operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  float& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
};
using Point3 = Vec3;
using Normal3 = Vec3;

inline Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator-(Vec3 a) {
  return {-a.x, -a.y, -a.z};
}
inline Vec3 operator*(Vec3 a, float s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline Vec3 operator*(float s, Vec3 a) {
  return a * s;
}
inline Vec3 operator/(Vec3 a, float s) {
  return a * (1 / s);
}
inline Vec3& operator+=(Vec3& a, Vec3 b) {
  return a = a + b;
}
inline Vec3& operator*=(Vec3& a, float s) {
  return a = a * s;
}

inline float Dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline float AbsDot(Vec3 a, Vec3 b) {
  return std::abs(Dot(a, b));
}
inline Vec3 Cross(Vec3 a, Vec3 b) {
  return {DifferenceOfProducts(a.y, b.z, a.z, b.y), DifferenceOfProducts(a.z, b.x, a.x, b.z),
          DifferenceOfProducts(a.x, b.y, a.y, b.x)};
}
inline float LengthSquared(Vec3 a) {
  return Dot(a, a);
}
inline float Length(Vec3 a) {
  return std::sqrt(LengthSquared(a));
}
inline Vec3 Normalize(Vec3 a) {
  return a / Length(a);
}
inline float DistanceSquared(Vec3 a, Vec3 b) {
  return LengthSquared(a - b);
}
inline float Distance(Vec3 a, Vec3 b) {
  return Length(a - b);
}
inline Vec3 Abs(Vec3 a) {
  return {std::abs(a.x), std::abs(a.y), std::abs(a.z)};
}
inline Vec3 Min(Vec3 a, Vec3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3 Max(Vec3 a, Vec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline float MaxComponent(Vec3 a) {
  return std::max(a.x, std::max(a.y, a.z));
}
inline Vec3 Lerp(float t, Vec3 a, Vec3 b) {
  return a * (1 - t) + b * t;
}
// n or -n, whichever lies in the hemisphere of v.
inline Vec3 FaceForward(Vec3 n, Vec3 v) {
  return Dot(n, v) < 0 ? -n : n;
}
inline bool IsFinite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
inline bool IsZero(Vec3 a) {
  return a.x == 0 && a.y == 0 && a.z == 0;
}

// Angle in radians between unit vectors, accurate near 0 and pi.
inline float AngleBetween(Vec3 a, Vec3 b) {
  if (Dot(a, b) < 0) return kPi - 2 * std::asin(std::min(1.0f, Length(a + b) / 2));
  return 2 * std::asin(std::min(1.0f, Length(b - a) / 2));
}

// Two unit vectors that complete the unit vector z to a right-handed orthonormal basis (Duff et al. 2017).
inline void CoordinateSystem(Vec3 z, Vec3* x, Vec3* y) {
  const float sign = std::copysign(1.0f, z.z);
  const float a = -1 / (sign + z.z);
  const float b = z.x * z.y * a;
  *x = {1 + sign * z.x * z.x * a, sign * b, -sign * z.x};
  *y = {b, sign + z.y * z.y * a, -z.y};
}

// An orthonormal basis in which directions are given by their components along x, y and z.
struct Frame {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  static Frame FromZ(Vec3 z) {
    Frame frame;
    frame.z = z;
    CoordinateSystem(z, &frame.x, &frame.y);
    return frame;
  }
  // x is `x` made orthogonal to the unit vector `z`; an arbitrary one if they are parallel.
  static Frame FromXZ(Vec3 x, Vec3 z) {
    // By the cross product, which stays orthogonal to z where x is nearly parallel to it.
    const Vec3 y = Cross(z, x);
    const float length = Length(y);
    if (!(length > 1e-12f)) return FromZ(z);
    Frame frame;
    frame.y = y / length;
    frame.x = Cross(frame.y, z);
    frame.z = z;
    return frame;
  }
  Vec3 ToLocal(Vec3 v) const { return {Dot(v, x), Dot(v, y), Dot(v, z)}; }
  Vec3 FromLocal(Vec3 v) const { return x * v.x + y * v.y + z * v.z; }
};

// Functions of a direction in a frame whose z axis is the surface normal.
inline float AbsCosTheta(Vec3 w) {
  return std::abs(w.z);
}
inline bool SameHemisphere(Vec3 a, Vec3 b) {
  return a.z * b.z > 0;
}

}  // namespace tessera
