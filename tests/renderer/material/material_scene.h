// The materials of a few directives, evaluated at one point.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "renderer/material/material.h"
#include "renderer/pbrt/parser.h"
#include "tests/renderer/memory_files.h"

namespace tessera {

// An image of one normal, (n + 1) / 2, as a PFM of little-endian floats.
inline std::string OnePixel(Vec3 value) {
  std::string bytes = "PF\n1 1\n-1.0\n";
  for (int c = 0; c < 3; ++c) {
    const float channel = value[c];
    bytes.append(reinterpret_cast<const char*>(&channel), sizeof channel);
  }
  return bytes;
}

// The materials and textures of a scene, and a point to evaluate them at.
class Materials {
 public:
  explicit Materials(const std::string& directives, const std::map<std::string, std::string>& files = {}) {
    files_.files = files;
    files_.files["tilted.pfm"] = OnePixel({0.5f + 0.3f, 0.5f, 0.5f + 0.4f});
    files_.files["grey.pfm"] = "Pf\n1 1\n-1.0\n" + std::string(4, '\0');
    Result<SceneDescription> scene =
        ParseSceneText(files_, "test.pbrt", "WorldBegin\n" + directives + "\nShape \"sphere\"\n");
    if (!scene) {
      error = scene.error().message;
      return;
    }
    const Result<void> added = builder_.Add(*scene);
    if (!added) error = added.error().message;
    if (!added) return;
    Result<MaterialTable> built = MaterialTable::Build(*scene, builder_);
    if (!built) error = built.error().message;
    if (!built) return;
    table = std::move(*built);
    textures = builder_.Finish();
    last = scene->shapes.front().material.index;
  }

  // The last material at a point of the plane z = 0, seen from above.
  Bsdf Evaluate() {
    context.p = interaction.p;
    context.uv = interaction.uv;
    return table.Evaluate(last, textures, context, interaction, wavelengths);
  }

  int FileReads() const { return files_.reads; }
  const std::vector<Diagnostic>& Warnings() const { return diagnostics_.warnings(); }

  std::string error;
  MaterialTable table;
  TextureTable textures;
  int last = 0;
  TextureContext context;
  SurfaceInteraction interaction = FlatPoint();
  SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(0.3f);

 private:
  static SurfaceInteraction FlatPoint() {
    SurfaceInteraction point;
    point.p = {0.25f, 0.5f, 0};
    point.uv = {0.25f, 0.5f};
    point.n = point.shading.n = {0, 0, 1};
    point.dpdu = point.shading.dpdu = {2, 0, 0};
    point.dpdv = point.shading.dpdv = {0, 3, 0};
    point.wo = Normalize({1, 1, 1});
    return point;
  }

  MemoryFiles files_;
  ImageCache images_{files_};
  Diagnostics diagnostics_;
  TextureBuilder builder_{files_, images_, diagnostics_, Transform()};
};

inline const Vec3 kUp{0, 0, 1};

inline float AlbedoOf(const Bsdf& bsdf) {
  return bsdf.Evaluate(kUp, kUp).f[0] * kPi;
}

}  // namespace tessera
