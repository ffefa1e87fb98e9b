#include "renderer/scene/gbuffer.h"

namespace tessera {
namespace {

// From rendering space to that of the film's geometry, at the time of a hit.
Transform GbufferFromRender(const LayerScene& scene, float time_s) {
  const Camera& camera = scene.world.camera;
  if (scene.gbuffer == GbufferSpace::kWorld) return camera.render_from_world().Inverse();
  return camera.RenderFromCamera(time_s).Inverse();
}

void PutXyz(Vec3 v, float* values) {
  values[0] = v.x;
  values[1] = v.y;
  values[2] = v.z;
}

// Of the first surface, if the sample sees one.
template <void (*kFill)(const SurfaceInteraction& surface, const LayerSample& sample, float* values)>
void OfHit(const LayerSample& sample, float* values) {
  if (sample.parts.surface) kFill(sample.parts.surface->interaction, sample, values);
}

void FillHit(const SurfaceInteraction&, const LayerSample&, float* values) {
  values[0] = 1;
}
void FillGbufferAlbedo(const SurfaceInteraction&, const LayerSample& sample, float* values) {
  PutXyz(sample.scene.sensor.ReflectanceToRgb(sample.parts.surface->albedo, sample.first_wavelengths),
         values);
}
void FillP(const SurfaceInteraction& surface, const LayerSample& sample, float* values) {
  PutXyz(GbufferFromRender(sample.scene, surface.time).ToPoint(surface.p), values);
}
void FillN(const SurfaceInteraction& surface, const LayerSample& sample, float* values) {
  PutXyz(Normalize(GbufferFromRender(sample.scene, surface.time).ToNormal(surface.n)), values);
}
void FillNs(const SurfaceInteraction& surface, const LayerSample& sample, float* values) {
  PutXyz(Normalize(GbufferFromRender(sample.scene, surface.time).ToNormal(surface.shading.n)), values);
}
// By how much z changes from one pixel to the next.
template <Vec3 Footprint::*kAxis>
void FillSlope(const SurfaceInteraction& surface, const LayerSample& sample, float* values) {
  const Footprint footprint =
      sample.scene.world.camera.ApproximateFootprint(surface.p, surface.n, sample.scene.footprint_scale);
  values[0] = GbufferFromRender(sample.scene, surface.time).ToVector(footprint.*kAxis).z;
}
void FillU(const SurfaceInteraction& surface, const LayerSample&, float* values) {
  values[0] = surface.uv.x;
}
void FillV(const SurfaceInteraction& surface, const LayerSample&, float* values) {
  values[0] = surface.uv.y;
}
template <int kComponent>
void FillSum(const SurfaceInteraction&, const LayerSample& sample, float* values) {
  values[0] = sample.rgb[kComponent];
}
void FillSquares(const SurfaceInteraction&, const LayerSample& sample, float* values) {
  for (int c = 0; c < 3; ++c) values[c] = sample.rgb[c] * sample.rgb[c];
}

constexpr RecordNeeds kGeometry{.surface = true};
constexpr RecordNeeds kWithAlbedo{.surface = true, .albedo = true};

constexpr Layer Vector(ChannelType type, void (*fill)(const LayerSample&, float*)) {
  return {"XYZ", type, MergeRule::kSum, kGeometry, fill};
}
constexpr Layer Single(std::string_view name, ChannelType type, void (*fill)(const LayerSample&, float*)) {
  return {"1", type, MergeRule::kSum, kGeometry, fill, name};
}

constexpr Kind<Layer> kGbufferLayers[] = {
    {"Albedo",
     Support::kSupported,
     {"RGB", ChannelType::kFloat, MergeRule::kSum, kWithAlbedo, OfHit<FillGbufferAlbedo>}},
    {"P", Support::kSupported, Vector(ChannelType::kHitFloat, OfHit<FillP>)},
    {"dzdx", Support::kSupported, Single("dzdx", ChannelType::kHitSlope, OfHit<FillSlope<&Footprint::dpdx>>)},
    {"dzdy", Support::kSupported, Single("dzdy", ChannelType::kHitSlope, OfHit<FillSlope<&Footprint::dpdy>>)},
    {"N", Support::kSupported, Vector(ChannelType::kDirection, OfHit<FillN>)},
    {"Ns", Support::kSupported, Vector(ChannelType::kDirection, OfHit<FillNs>)},
    {"u", Support::kSupported, Single("u", ChannelType::kHitFloat, OfHit<FillU>)},
    {"v", Support::kSupported, Single("v", ChannelType::kHitFloat, OfHit<FillV>)},
    {"Variance",
     Support::kSupported,
     {"RGB", ChannelType::kHitSquare, MergeRule::kSum, kGeometry, OfHit<FillSquares>}},
    {"Variance.R.sum", Support::kSupported,
     Single("Variance.R.sum", ChannelType::kHitSum, OfHit<FillSum<0>>)},
    {"Variance.G.sum", Support::kSupported,
     Single("Variance.G.sum", ChannelType::kHitSum, OfHit<FillSum<1>>)},
    {"Variance.B.sum", Support::kSupported,
     Single("Variance.B.sum", ChannelType::kHitSum, OfHit<FillSum<2>>)},
    {"hit.W", Support::kSupported, Single("hit.W", ChannelType::kHitWeight, OfHit<FillHit>)},
    {"hit.samples", Support::kSupported, Single("hit.samples", ChannelType::kHitCount, OfHit<FillHit>)},
};

}  // namespace

std::span<const Kind<Layer>> GbufferLayers() {
  return kGbufferLayers;
}

void AddGbufferLayers(std::vector<Channel>& channels) {
  for (const Kind<Layer>& kind : kGbufferLayers) {
    for (const Channel& channel : ChannelsOf(kind)) AddChannel(channels, channel);
  }
}

}  // namespace tessera
