// Builds textures from scene text over files in memory.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "renderer/color/color_space.h"
#include "renderer/pbrt/parser.h"
#include "renderer/texture/texture_builder.h"
#include "tests/renderer/memory_files.h"

namespace tessera {

// A grey or RGB portable float map, rows from the top in `values`.
inline std::string FloatMap(int width, int height, const std::vector<float>& values) {
  const int channels = static_cast<int>(values.size()) / (width * height);
  std::string file = std::string(channels == 3 ? "PF" : "Pf") + "\n" + std::to_string(width) + " " +
                     std::to_string(height) + "\n-1.0\n";
  for (int y = height - 1; y >= 0; --y) {
    file.append(reinterpret_cast<const char*>(&values[static_cast<size_t>(y) * width * channels]),
                static_cast<size_t>(width) * channels * sizeof(float));
  }
  return file;
}

// A scene that has only textures, and one diffuse material whose parameters refer to them.
class TextureScene {
 public:
  // `cache` keeps what is made of the files; `images_floor` as in ImageCache.
  explicit TextureScene(std::map<std::string, std::string> files = {},
                        std::shared_ptr<SharedCache> cache = nullptr,
                        uint64_t images_floor = kImagesBytesFloor)
      : files_(std::move(files), std::move(cache)), images_(files_, images_floor) {}

  // The first error of parsing, building or looking up, or "".
  std::string Build(const std::string& textures, const std::string& material_parameters = "") {
    const std::string text =
        "WorldBegin\n" + textures + "\nMaterial \"diffuse\" " + material_parameters + "\n";
    Result<SceneDescription> scene = ParseSceneText(files_, "a.pbrt", text);
    if (!scene) return scene.error().message;
    scene_ = std::move(scene).value();
    builder_ = std::make_unique<TextureBuilder>(files_, images_, diagnostics_, render_from_world);
    const Result<void> added = builder_->Add(scene_);
    return added ? "" : added.error().message;
  }

  // Parameters of the material. Call before Finish; the last error is kept.
  SpectrumInput SpectrumInputOf(std::string_view name, SpectrumUse use = SpectrumUse::kAlbedo) {
    ParameterReader reader(scene_.materials.back().entity);
    const SpectrumInput input = builder_->SpectrumOf(reader, name, use, Spectrum::Constant(-1));
    Keep(reader);
    return input;
  }
  FloatInput FloatInputOf(std::string_view name) {
    ParameterReader reader(scene_.materials.back().entity);
    const FloatInput input = builder_->Float(reader, name, -1);
    Keep(reader);
    return input;
  }
  TextureTable Finish() { return builder_->Finish(); }
  const std::string& error() const { return error_; }
  const Diagnostics& diagnostics() const { return diagnostics_; }

  Transform render_from_world;

 private:
  void Keep(ParameterReader& reader) {
    if (!reader.failed()) reader.IgnoreRest();
    const Result<void> end = reader.Finish();
    error_ = end ? "" : end.error().message;
  }

  MemoryFiles files_;
  ImageCache images_;
  SceneDescription scene_;
  Diagnostics diagnostics_;
  std::unique_ptr<TextureBuilder> builder_;
  std::string error_;
};

inline TextureContext ContextAtUv(float u, float v) {
  TextureContext context;
  context.uv = {u, v};
  context.n = {0, 0, 1};
  return context;
}

}  // namespace tessera
