#include "renderer/integrator/plain_vertices.h"

#include "renderer/light/rectangle_emitter.h"
#include "renderer/math/sampling.h"
#include "renderer/shape/triangle_lanes.h"

namespace tessera {

PlainVertices::Outcome PlainVertices::Scatter(LaneSet lanes, const SurfacePaths& paths) {
  paths_ = &paths;
  lanes_ = lanes;
  const Rays8 rays(lanes, paths.hits.rays);
  Place(rays);
  const LaneSet accepted = lanes_;
  BeginEvents();
  if (lanes_ != 0) {
    ChooseLights();
    SampleRectangles();
    SampleDirections();
    AddLights(rays);
    Leave(rays);
  }
  return {lanes & ~accepted, accepted & ~lanes_};
}

// Finds the surface points, and removes the paths that the following steps cannot serve from lanes_.
void PlainVertices::Place(const Rays8& rays) {
  TrianglePlaces8 places;
  const Spectrum* reflectances[kLanes];
  const int first = std::countr_zero(lanes_);
  for (int lane = 0; lane < kLanes; ++lane) {
    const Hit& hit = paths_->hits.hits[HasLane(lanes_, lane) ? lane : first];
    const PlainSurfaces::Surface& surface = surfaces_.At(hit);
    places.points[lane] = surface.points;
    places.normals[lane] = surface.normals;
    places.corners[lane] = surface.indices + 3 * size_t{hit.primitive};
    places.smooth |= LaneSet{surface.has_normals} << lane;
    places.flipped |= LaneSet{surface.flip_normals} << lane;
    reflectances[lane] = surface.reflectance;
  }
  lanes_ &= FindPoints(places, rays, &points_);
  wo_z_ = Dot(Normalize(-rays.d), points_.shading_n);
  lanes_ &= ~(wo_z_ == Float8(0)).lanes();
  ForEachLane(lanes_, [&](int lane) {
    f_[lane] = Clamp(reflectances[lane]->Sample(path(lane).context_.wavelengths), 0, 1) * kInvPi;
    if (!AnyNonZero(f_[lane])) End(lane);
  });
}

void PlainVertices::BeginEvents() {
  const Vec3x8 &p = points_.p, &error = points_.p_error, &n = points_.n, &ns = points_.shading_n;
  const Quads first = Untranspose(p.x, p.y, p.z, error.x), second = Untranspose(error.y, error.z, n.x, n.y),
              third = Untranspose(n.z, ns.x, ns.y, ns.z);
  ForEachLane(lanes_, [&](int lane) {
    SurfacePath& path = this->path(lane);
    if (!path.PassesDelayedRoulette() || path.depth_++ == path.context_.settings.max_depth) return End(lane);
    path.interfaces_ = 0;
    path.is_shadowed_ = false;
    ReferencePoint& reference = path.previous_;
    static_assert(offsetof(ReferencePoint, shading_n) == 9 * sizeof(float));
    float* const row = &reference.p.x;
    _mm_storeu_ps(row, first.lane[lane]);
    _mm_storeu_ps(row + 4, second.lane[lane]);
    _mm_storeu_ps(row + 8, third.lane[lane]);
    reference.time = path.ray_.time;
    reference.light_links = kAllLightLinks;
    reference.lobe = {};
  });
}

void PlainVertices::ChooseLights() {
  lit_ = delta_ = in_rectangles_ = 0;
  ForEachLane(lanes_, [&](int lane) {
    SurfacePath& path = this->path(lane);
    Sampler& sampler = path.context_.sampler;
    path.SetLightShare();
    const float share = path.light_share_;
    const VertexNumbers numbers = sampler.GetVertex();
    const Point2 u_light = numbers.u_light, u_direction = numbers.u_direction;
    float u_choice = numbers.u_choice;
    u_direction_x_.at[lane] = u_direction.x;
    u_direction_y_.at[lane] = u_direction.y;
    if (u_choice >= share) return;
    u_choice = std::min(u_choice / share, kOneMinusEpsilon);
    const std::optional<ChosenLight> chosen =
        only_light_ ? only_light_ : world_.lights.Choose(path.previous_, u_choice);
    if (!chosen) return;
    chosen_[lane] = *chosen;
    pmf_.at[lane] = chosen->pmf;
    share_.at[lane] = share;
    u_light_x_.at[lane] = u_light.x;
    u_light_y_.at[lane] = u_light.y;
    if (RectangleOf(chosen->light)) {
      in_rectangles_ |= LaneSet{1} << lane;
    } else {
      SampleAlone(lane);
    }
  });
  lights_ = SampledAlone();
}

void PlainVertices::SampleAlone(int lane) {
  const Point2 u{u_light_x_.at[lane], u_light_y_.at[lane]};
  const SurfacePath& path = this->path(lane);
  const std::optional<SampledLight> sampled = SampleLight(path.context_, chosen_[lane], path.previous_, u);
  if (!sampled) return;
  const LightSample& light = samples_[lane] = sampled->light;
  alone_p_.Set(lane, light.p);
  alone_error_.Set(lane, light.p_error);
  alone_n_.Set(lane, light.n);
  alone_wi_.Set(lane, light.wi);
  alone_pdf_.at[lane] = sampled->pdf * share_.at[lane];
  lit_ |= LaneSet{1} << lane;
  delta_ |= LaneSet{light.is_delta} << lane;
}

void PlainVertices::SampleRectangles() {
  while (in_rectangles_ != 0) {
    const int light = chosen_[std::countr_zero(in_rectangles_)].light;
    LaneSet same = 0;
    ForEachLane(in_rectangles_, [&](int lane) { same |= LaneSet{chosen_[lane].light == light} << lane; });
    in_rectangles_ &= ~same;
    SampleRectangle(same, light);
  }
}

// As SampleLight and AreaLights::Sample.
void PlainVertices::SampleRectangle(LaneSet lanes, int light) {
  const RectangleLight rectangle = *RectangleOf(light);
  const Normal3 n = rectangle.emitter->n();
  const RectangleSamples8 samples =
      rectangle.emitter->SampleFar(points_, {u_light_x_.Load(), u_light_y_.Load()}, rectangle.two_sided);
  const Vec3x8 to_light = samples.p - points_.p;
  const Float8 distance_squared = LengthSquared(to_light);
  const Vec3x8 wi = to_light / Sqrt(distance_squared);
  LaneSet seen = lanes & samples.seen & (distance_squared > Float8(0)).lanes();
  if (!rectangle.two_sided) seen &= (Dot(Vec3x8(n), wi) < Float8(0)).lanes();
  ForEachLane(seen, [&](int lane) {
    LightSample& sample = samples_[lane];
    sample.L = rectangle.L->Sample(path(lane).context_.wavelengths) * rectangle.scale;
    sample.map = nullptr;
    if (!AnyNonZero(sample.L)) seen &= ~(LaneSet{1} << lane);
  });
  lit_ |= seen;
  if (rectangle.is_delta) delta_ |= seen;
  SetLights(seen, {samples.p, Vec3x8(rectangle.emitter->p_error()), Vec3x8(n), wi,
                   pmf_.Load() * samples.pdf * share_.Load()});
  const LaneSet near = lanes & ~samples.far;
  if (near == 0) return;
  ForEachLane(near, [&](int lane) { SampleAlone(lane); });
  SetLights(near, SampledAlone());
}

PlainVertices::SampledLights PlainVertices::SampledAlone() const {
  return {alone_p_.Load(), alone_error_.Load(), alone_n_.Load(), alone_wi_.Load(), alone_pdf_.Load()};
}

void PlainVertices::SetLights(LaneSet lanes, const SampledLights& lights) {
  const Mask8 mask = MaskOf(lanes);
  lights_.p = Select(mask, lights.p, lights_.p);
  lights_.p_error = Select(mask, lights.p_error, lights_.p_error);
  lights_.n = Select(mask, lights.n, lights_.n);
  lights_.wi = Select(mask, lights.wi, lights_.wi);
  lights_.pdf = Select(mask, lights.pdf, lights_.pdf);
}

// As DiffuseBxdf::Sample and Bsdf::Sample.
void PlainVertices::SampleDirections() {
  const Vec3x8& z = points_.shading_n;
  const Vec2x8 disk = SampleUniformDiskConcentricOf(Vec2x8{u_direction_x_.Load(), u_direction_y_.Load()});
  const Float8 height = SafeSqrt(Float8(1) - disk.x * disk.x - disk.y * disk.y);
  wi_pdf_ = height * Float8(kInvPi);
  directed_ = lanes_ & (wi_pdf_ > Float8(0)).lanes();
  const Frame8 frame(z);
  wi_ = frame.x * disk.x + frame.y * disk.y + z * CopySign(height, wo_z_);
}

// As AddSurfaceLight of PathTracer.
void PlainVertices::AddLights(const Rays8& rays) {
  const Float8 wi_z = Dot(lights_.wi, points_.shading_n);
  const LaneSet lit = lit_ & (wo_z_ * wi_z > Float8(0)).lanes();
  if (lit == 0) return;
  const Vec3x8 start = OffsetRayOrigin(points_.p, points_.p_error, points_.n, lights_.p - points_.p);
  const Vec3x8 end = OffsetRayOrigin(lights_.p, lights_.p_error, lights_.n, start - lights_.p);
  Rays8(start, end - start, Float8(1 - kShadowEpsilon), rays.time).Store(lit, [&](int lane) {
    return &shadow_rays_[lane];
  });
  const Float8 cosine = Abs(wi_z);
  const Float8 weight =
      Select(MaskOf(delta_), Float8(1), PowerHeuristicOf(lights_.pdf, cosine * Float8(kInvPi)));
  LaneFloats factors;
  (cosine * weight / lights_.pdf).Store(factors.at);
  path(std::countr_zero(lit)).context_.counts.shadow += static_cast<uint64_t>(std::popcount(lit));
  const LaneSet occluded = world_.accelerator->lane_search()->Occluded(lit, shadow_rays_);
  ForEachLane(lit & ~occluded, [&](int lane) {
    SurfacePath& path = this->path(lane);
    const SampledSpectrum radiance = samples_[lane].Radiance(path.context_.wavelengths);
    path.sink_.radiance += path.transport_.Throughput() * (f_[lane] * radiance * factors.at[lane]);
  });
}

// As Leave of PathTracer.
void PlainVertices::Leave(const Rays8& rays) {
  lanes_ &= directed_;
  const Float8 cosine = Abs(Dot(wi_, points_.shading_n));
  LaneFloats weights, pdfs;
  (cosine / wi_pdf_).Store(weights.at);
  wi_pdf_.Store(pdfs.at);
  Rays8(OffsetRayOrigin(points_.p, points_.p_error, points_.n, wi_), wi_,
        Float8(std::numeric_limits<float>::infinity()), rays.time)
      .Store(lanes_, [&](int lane) { return &path(lane).ray_; });
  ForEachLane(lanes_, [&](int lane) {
    SurfacePath& path = this->path(lane);
    path.transport_.Scatter(f_[lane] * weights.at[lane], pdfs.at[lane]);
    path.weigh_ = path.was_spread_ = true;
    path.is_sharp_ = false;  // its density is at most 1 / pi
    if (!path.SurvivesRoulette()) End(lane);
  });
}

}  // namespace tessera
