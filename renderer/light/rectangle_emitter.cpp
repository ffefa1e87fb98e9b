#include "renderer/light/rectangle_emitter.h"

#include "renderer/math/double_lanes.h"
#include "renderer/shape/solid_angle_density.h"

namespace tessera {
namespace {

// From points farther from the center than the square root of this times half the diagonal, the rectangle is
// sampled by area: bilinear weights follow what arrives from its points closely enough there, and the
// spherical map costs several times more.
constexpr float kFarSquared = 2;
// Nearer, below this solid angle, in steradians, it is sampled by area, too: the spherical map loses its
// precision.
constexpr float kSolidAngleMin = 1e-3f;
// Of the cosine between the edges. The solid angle has an error of this size.
constexpr float kRightAngleTolerance = 1e-5f;

// The corners of two triangles with a common edge, which is the diagonal from (1, 0) to (0, 1).
std::optional<PatchPoints> CommonPatch(const TrianglePoints& a, const TrianglePoints& b) {
  const std::array<Point3, 3> of_a = {a.p0, a.p1, a.p2}, of_b = {b.p0, b.p1, b.p2};
  const auto alone = [](const std::array<Point3, 3>& points, const std::array<Point3, 3>& others) {
    int index = -1;
    for (int i = 0; i < 3; ++i) {
      if (points[i] == others[0] || points[i] == others[1] || points[i] == others[2]) continue;
      if (index >= 0) return -1;
      index = i;
    }
    return index;
  };
  const int a_alone = alone(of_a, of_b), b_alone = alone(of_b, of_a);
  if (a_alone < 0 || b_alone < 0) return std::nullopt;
  return PatchPoints{of_a[a_alone], of_a[(a_alone + 1) % 3], of_a[(a_alone + 2) % 3], of_b[b_alone]};
}

bool IsExactRectangle(const PatchPoints& patch) {
  if (!IsRectangle(patch) || !IsParallelogram(patch)) return false;
  const Vec3 ex = patch.p10 - patch.p00, ey = patch.p01 - patch.p00;
  return AbsDot(Normalize(ex), Normalize(ey)) <= kRightAngleTolerance;
}

// Whether every normal of the triangle that sampling may take is `n`.
bool FacesAlong(const TriangleMesh& mesh, uint32_t primitive, Normal3 n) {
  constexpr float kSame = 0.9999f;
  const TrianglePoints triangle = mesh.At(primitive);
  for (const Point2 corner : {Point2{0, 0}, Point2{1, 0}, Point2{0, 1}}) {
    if (!(Dot(mesh.Normal(primitive, triangle, corner.x, corner.y), n) > kSame)) return false;
  }
  return true;
}

}  // namespace

std::optional<RectangleEmitter> RectangleEmitter::Find(const TriangleMesh& mesh, uint32_t primitive) {
  const TrianglePoints first = mesh.At(primitive);
  const std::optional<PatchPoints> patch = CommonPatch(first, mesh.At(primitive + 1));
  if (!patch || !IsExactRectangle(*patch)) return std::nullopt;
  const Normal3 n = mesh.Normal(primitive, first, 0, 0);
  if (!FacesAlong(mesh, primitive, n) || !FacesAlong(mesh, primitive + 1, n)) return std::nullopt;
  const RectangleEmitter rectangle(*patch, n);
  if (!(rectangle.Area() > 0)) return std::nullopt;
  return rectangle;
}

RectangleEmitter::RectangleEmitter(const PatchPoints& corners, Normal3 n)
    : corner_(corners.p00),
      ex_(corners.p10 - corners.p00),
      ey_(corners.p01 - corners.p00),
      unit_x_(Normalize(ex_)),
      unit_y_(Normalize(ey_)),
      width_(Length(ex_)),
      height_(Length(ey_)),
      center_(corner_ + (ex_ + ey_) * 0.5f),
      radius_squared_(LengthSquared(ex_ + ey_) / 4),
      n_(n),
      p_error_(PatchPointError(corners)),
      plane_error_(Dot(Abs(n), p_error_)) {
  const Point3 across = corner_ + ex_;
  corners_ = {corner_, across, corner_ + ey_, across + ey_};
  corners_x_ = {corners_[0].x, corners_[1].x, corners_[2].x, corners_[3].x};
  corners_y_ = {corners_[0].y, corners_[1].y, corners_[2].y, corners_[3].y};
  corners_z_ = {corners_[0].z, corners_[1].z, corners_[2].z, corners_[3].z};
}

float RectangleEmitter::Height(const ReferencePoint& reference) const {
  const float height = Dot(n_, reference.p - corner_);
  return std::abs(height) <= Dot(Abs(n_), reference.p_error) + plane_error_ ? 0 : height;
}

RectangleEmitter::View RectangleEmitter::SeenFrom(const ReferencePoint& reference, float height) const {
  const Vec3 to_corner = corner_ - reference.p;
  View view{
      SphericalRectangle(Dot(to_corner, unit_x_), Dot(to_corner, unit_y_), width_, height_, std::abs(height)),
      {}};
  if (!IsOnSurface(reference)) return view;
  const Float4 weights = CornerWeights(reference, corners_x_, corners_y_, corners_z_);
  view.weights = {weights[0], weights[1], weights[2], weights[3]};
  return view;
}

std::optional<BilinearWeights> RectangleEmitter::FarWeights(const ReferencePoint& reference) const {
  const float center_squared = LengthSquared(center_ - reference.p);
  if (!(center_squared > kFarSquared * radius_squared_)) return std::nullopt;
  const Float4 x = corners_x_ - reference.p.x, y = corners_y_ - reference.p.y, z = corners_z_ - reference.p.z;
  const Float4 inverse = 1 / Sqrt(x * x + y * y + z * z);
  // Relative to the center, so that no power leaves the range of float.
  const Float4 nearness = inverse * std::sqrt(center_squared);
  Float4 weights = nearness * nearness * nearness;  // the emitter's cosine over the squared distance
  if (IsOnSurface(reference)) {
    const Normal3 n = reference.shading_n;
    const Float4 cosines = (n.x * x + n.y * y + n.z * z) * inverse;
    weights *= Max(Abs(cosines), Float4(kCornerCosineMin));
  }
  return BilinearWeights{weights[0], weights[1], weights[2], weights[3]};
}

Point2 RectangleEmitter::PlaceOf(Point3 p) const {
  const Vec3 offset = p - corner_;
  return {std::clamp(Dot(offset, unit_x_) / width_, 0.0f, 1.0f),
          std::clamp(Dot(offset, unit_y_) / height_, 0.0f, 1.0f)};
}

std::optional<ShapeSample> RectangleEmitter::Sample(const ReferencePoint& reference, Point2 u,
                                                    bool two_sided) const {
  const float height = Height(reference);
  if (height == 0 || (height < 0 && !two_sided)) return std::nullopt;
  ShapeSample sample;
  float area_pdf = 0;
  if (const std::optional<BilinearWeights> weights = FarWeights(reference)) {
    u = SampleBilinear(u, *weights);
    area_pdf = BilinearPdf(u, *weights) / Area();
  } else {
    const View view = SeenFrom(reference, height);
    if (view.sphere.area() >= kSolidAngleMin) {
      u = SampleBilinear(u, view.weights);
      sample.pdf = BilinearPdf(u, view.weights) / view.sphere.area();
      u = view.sphere.Sample(u);
    } else {
      area_pdf = 1 / Area();
    }
  }
  sample.p = (Double3(corner_) + Double3(ex_) * u.x + Double3(ey_) * u.y).ToFloat();
  sample.p_error = p_error_;
  sample.n = n_;
  if (area_pdf > 0) sample.pdf = PerSolidAngle(area_pdf, reference.p, sample.p, n_);
  if (!(sample.pdf > 0)) return std::nullopt;
  return sample;
}

RectangleSamples8 RectangleEmitter::SampleFar(const SurfacePoints8& references, Vec2x8 u,
                                              bool two_sided) const {
  RectangleSamples8 samples;
  const Vec3x8 n(n_);
  const Float8 height = Dot(n, references.p - Vec3x8(corner_));
  const Mask8 is_in_plane = Abs(height) <= Dot(Abs(n), references.p_error) + Float8(plane_error_);
  LaneSet in_front = ~is_in_plane.lanes();
  if (!two_sided) in_front &= ~(height < Float8(0)).lanes();

  const Float8 center_squared = LengthSquared(Vec3x8(center_) - references.p);
  samples.far = (center_squared > Float8(kFarSquared * radius_squared_)).lanes();
  const auto weight = [&](size_t corner) {
    const Vec3x8 to = Vec3x8(corners_[corner]) - references.p;
    const Float8 inverse = Float8(1) / Sqrt(to.x * to.x + to.y * to.y + to.z * to.z);
    const Float8 nearness = inverse * Sqrt(center_squared);
    const Float8 cosine = Dot(references.shading_n, to) * inverse;
    return nearness * nearness * nearness * Max(Float8(kCornerCosineMin), Abs(cosine));
  };
  const BilinearWeightsOf<Float8> weights{weight(0), weight(1), weight(2), weight(3)};
  const Vec2x8 place = SampleBilinear(u, weights);
  const Float8 area_pdf = BilinearPdf(place, weights) / Float8(Area());

  samples.p = (Double3x8(Vec3x8(corner_)) + Double3x8(Vec3x8(ex_)) * Double8(place.x) +
               Double3x8(Vec3x8(ey_)) * Double8(place.y))
                  .ToFloat();
  const Vec3x8 to_point = samples.p - references.p;
  const Float8 distance_squared = LengthSquared(to_point);
  const Float8 cosine = Abs(Dot(n, to_point)) / Sqrt(distance_squared);
  samples.pdf = area_pdf * distance_squared / cosine;
  const Mask8 is_sampled = (area_pdf > Float8(0)) & (samples.pdf > Float8(0)) &
                           (samples.pdf < Float8(std::numeric_limits<float>::infinity()));
  samples.seen = samples.far & in_front & is_sampled.lanes();
  return samples;
}

float RectangleEmitter::Pdf(const ReferencePoint& reference, Point3 p) const {
  const float height = Height(reference);
  if (height == 0) return 0;
  if (const std::optional<BilinearWeights> weights = FarWeights(reference))
    return PerSolidAngle(BilinearPdf(PlaceOf(p), *weights) / Area(), reference.p, p, n_);
  const View view = SeenFrom(reference, height);
  if (view.sphere.area() < kSolidAngleMin) return PerSolidAngle(1 / Area(), reference.p, p, n_);
  if (!IsOnSurface(reference)) return 1 / view.sphere.area();
  return BilinearPdf(view.sphere.Invert(PlaceOf(p)), view.weights) / view.sphere.area();
}

}  // namespace tessera
