#include <algorithm>
#include <cmath>

#include "renderer/bxdf/measured_bxdf.h"
#include "renderer/light/ies_profile.h"
#include "renderer/material/measured_brdf_file.h"
#include "renderer/pbrt/parser.h"
#include "renderer/shape/ply_reader.h"
#include "renderer/util/check.h"
#include "renderer/util/file.h"
#include "tests/fuzz/targets.h"
#include "tests/renderer/memory_files.h"

namespace tessera {

// A scene that may include itself and another file.
bool FuzzSceneText(std::string_view bytes) {
  MemoryFiles files({{"a.pbrt", std::string(bytes)}, {"b.pbrt", "Shape \"sphere\"\n"}});
  const Result<SceneDescription> scene = ParseScene(files, "a.pbrt");
  if (!scene) TESSERA_CHECK(!scene.error().message.empty());
  return scene.has_value();
}

bool FuzzGzip(std::string_view bytes) {
  constexpr uint64_t kSizeMax = uint64_t{1} << 20;
  const Result<std::string> text = Gunzip(bytes, "a.gz", kSizeMax);
  TESSERA_CHECK(!text || text->size() <= kSizeMax);
  return text.has_value();
}

bool FuzzPly(std::string_view bytes) {
  const Result<PlyMesh> mesh = ReadPly(bytes, "a.ply");
  if (!mesh) {
    TESSERA_CHECK(mesh.error().message.starts_with("a.ply"));
    return false;
  }
  const auto is_valid = [&](uint32_t index) { return index < mesh->P.size(); };
  TESSERA_CHECK(std::ranges::all_of(mesh->triangles, is_valid) && std::ranges::all_of(mesh->quads, is_valid));
  TESSERA_CHECK(std::ranges::all_of(mesh->P, [](Point3 p) { return IsFinite(p); }));
  TESSERA_CHECK(mesh->triangles.size() % 3 == 0 && mesh->quads.size() % 4 == 0);
  TESSERA_CHECK(mesh->N.empty() || mesh->N.size() == mesh->P.size());
  TESSERA_CHECK(mesh->uv.empty() || mesh->uv.size() == mesh->P.size());
  return true;
}

bool FuzzIes(std::string_view bytes) {
  const Result<IesProfile> profile = IesProfile::Read(bytes);
  if (!profile) {
    TESSERA_CHECK(profile.error().message.starts_with("line "));
    return false;
  }
  TESSERA_CHECK(profile->Mean() >= 0 && std::isfinite(profile->Mean()));
  for (const Vec3 d : {Vec3{0, 0, -1}, Vec3{0, 0, 1}, Vec3{0.6f, -0.48f, 0.64f}, Vec3{-1, -0.0f, 0}}) {
    const float intensity = profile->Intensity(d);
    TESSERA_CHECK(intensity >= 0 && std::isfinite(intensity));
  }
  return true;
}

bool FuzzMeasuredBrdf(std::string_view bytes) {
  const Result<MeasuredBrdf> brdf = ReadMeasuredBrdf(bytes);
  if (!brdf) {
    TESSERA_CHECK(!brdf.error().message.empty());
    return false;
  }
  const MeasuredBxdf bxdf(*brdf, {400, 500, 600, 700});
  for (const Vec3 wo : {Vec3{0, 0, 1}, Vec3{0.6f, 0, 0.8f}, Vec3{-0.48f, 0.6f, -0.64f}}) {
    if (const auto sample = bxdf.Sample(wo, 0.5f, {0.25f, 0.75f})) bxdf.Evaluate(wo, sample->wi);
  }
  return true;
}

}  // namespace tessera
