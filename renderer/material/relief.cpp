#include "renderer/material/relief.h"

#include <fmt/format.h>

#include <cmath>

namespace tessera {
namespace {

constexpr float kShiftDefault = 0.0005f;  // in u or v, where the footprint is unknown

// Does nothing where the tangents have no finite normal.
void SetTangents(Vec3 dpdu, Vec3 dpdv, SurfaceInteraction& interaction) {
  const Vec3 cross = Cross(dpdu, dpdv);
  const float length = Length(cross);
  if (!(length > 0) || !std::isfinite(length)) return;
  interaction.shading.n = FaceForward(cross / length, interaction.n);
  interaction.shading.dpdu = dpdu;
  interaction.shading.dpdv = dpdv;
}

float Shift(float per_x, float per_y) {
  const float shift = 0.5f * (std::abs(per_x) + std::abs(per_y));
  return shift > 0 && std::isfinite(shift) ? shift : kShiftDefault;
}

}  // namespace

Relief Relief::Read(MaterialReader& reader) {
  Relief relief;
  ParameterReader& parameters = reader.parameters;
  relief.displacement_ = reader.textures.FindFloat(parameters, "displacement");
  const bool is_flat =
      relief.displacement_ && relief.displacement_->IsConstant() && relief.displacement_->constant == 0;
  if (is_flat) relief.displacement_.reset();
  const std::optional<std::string> name = parameters.FindString("normalmap");
  if (!name) return relief;
  const auto image = reader.textures.images().Get(*name, ColorEncoding{});
  if (!image) {
    parameters.FailAt("normalmap", image.error().message);
    return relief;
  }
  const auto channels = (*image)->RgbChannels();
  if (!channels) {
    parameters.FailAt("normalmap", fmt::format("normal map \"{}\" needs the channels R, G and B", *name));
    return relief;
  }
  relief.normal_map_ = std::make_shared<const NormalMap>(*image, *channels);
  return relief;
}

void Relief::ApplyBumpMap(const TextureTable& textures, const TextureContext& context,
                          SurfaceInteraction& interaction) const {
  const SurfaceInteraction::Shading& shading = interaction.shading;
  const float du = Shift(context.dudx, context.dudy), dv = Shift(context.dvdx, context.dvdy);
  TextureContext shifted = context;
  shifted.p = context.p + shading.dpdu * du;
  shifted.uv = context.uv + Vec2{du, 0};
  const float at_u = textures.Evaluate(*displacement_, shifted);
  shifted.p = context.p + shading.dpdv * dv;
  shifted.uv = context.uv + Vec2{0, dv};
  const float at_v = textures.Evaluate(*displacement_, shifted);
  const float here = textures.Evaluate(*displacement_, context);
  const Vec3 dpdu = shading.dpdu + shading.n * ((at_u - here) / du) + shading.dndu * here;
  const Vec3 dpdv = shading.dpdv + shading.n * ((at_v - here) / dv) + shading.dndv * here;
  SetTangents(dpdu, dpdv, interaction);
}

void Relief::ApplyNormalMap(SurfaceInteraction& interaction) const {
  const SurfaceInteraction::Shading& shading = interaction.shading;
  const Vec3 n = Frame::FromXZ(shading.dpdu, shading.n).FromLocal(normal_map_->Lookup(interaction.uv));
  const Frame frame = Frame::FromXZ(shading.dpdu, n);
  SetTangents(frame.x * Length(shading.dpdu), frame.y * Length(shading.dpdv), interaction);
}

}  // namespace tessera
