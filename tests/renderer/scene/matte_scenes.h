// Scenes with mattes, and the independent reader of their pictures.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include "renderer/film/merge_rules.h"
#include "renderer/film/merger.h"
#include "renderer/scene/scene.h"
#include "tests/build_paths.h"
#include "tests/renderer/memory_files.h"

namespace tessera {

constexpr const char* kMatteLayers[] = {"CryptoObject", "CryptoMaterial", "CryptoAsset"};
// Their ids are sets in the order of the frame's channels.
constexpr size_t kMatteCount = std::size(kMatteLayers);

// Things that are blurred by motion and lens, have holes, are instanced, and whose names need escapes.
constexpr const char* kMatteScene = R"(
LookAt 0 2 -8  0 0.5 0  0 1 0
Camera "perspective" "float fov" 45 "float lensradius" 0.15 "float focaldistance" 8 "float shutterclose" 1
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
PixelFilter "mitchell"
Sampler "zsobol" "integer pixelsamples" 32
WorldBegin
LightSource "infinite"
MakeNamedMaterial "white \"paint\"" "string type" "diffuse"
Texture "holes" "float" "checkerboard" "float uscale" 8 "float vscale" 8 "float tex1" 0 "float tex2" 1
ObjectBegin "tree"
  Material "diffuse" Shape "sphere" "float radius" 0.6
  Material "conductor" Shape "sphere" "float radius" 0.3 "string name" "leaves"
ObjectEnd
NamedMaterial "white \"paint\""
Shape "trianglemesh" "point3 P" [ -9 -1 -9  9 -1 -9  9 -1 9  -9 -1 9 ] "integer indices" [ 0 1 2 0 2 3 ]
  "string name" "floor" "string asset" "set\\1"
Material "dielectric" Shape "sphere" "string name" "Glasgefäß"
AttributeBegin
  Translate -3 0 0 ActiveTransform EndTime Translate 0.5 0 0 ActiveTransform All ObjectInstance "tree"
AttributeEnd
AttributeBegin Translate 3 0 1 ObjectInstance "tree" AttributeEnd
AttributeBegin Translate 1.6 1 -2 Material "diffuse" Shape "disk" "texture alpha" "holes" AttributeEnd
AttributeBegin
  Translate -1 2 2 ActiveTransform EndTime Translate 0 0.5 0 ActiveTransform All Shape "sphere" "float radius" 0.7
AttributeEnd
)";

inline std::unique_ptr<Scene> LoadNamed(const std::string& text, std::set<std::string> layers,
                                        std::map<std::string, std::string> files = {},
                                        std::optional<uint32_t> cryptomatte_levels = {}) {
  files["scene.pbrt"] = text;
  MemoryFiles source(std::move(files));
  RenderOptions options;
  options.aovs = std::move(layers);
  options.cryptomatte_levels = cryptomatte_levels;
  options.exr_type = ExrType::kFloat;
  auto scene = Scene::Load(source, "scene.pbrt", options, Scene::Depth::kRender);
  if (!scene) throw std::runtime_error(scene.error().message);
  return std::move(*scene);
}

inline std::unique_ptr<Scene> LoadMattes(const std::string& text,
                                         std::map<std::string, std::string> files = {}) {
  return LoadNamed(text, {"crypto_object", "crypto_material", "crypto_asset"}, std::move(files));
}

// Renders the frame in units of at most `unit` samples.
inline FramePicture RenderMattes(const Scene& scene, uint32_t unit) {
  Merger merger(scene.frame());
  for (int tile = 0; tile < scene.frame().TileCount(); ++tile) {
    for (uint32_t begin = 0; begin < scene.frame().samples_per_pixel;) {
      SampleRange range{begin, DyadicSizeMax(begin, scene.frame().samples_per_pixel)};
      while (range.size > unit) range = range.Left();
      EXPECT_TRUE(merger.Add(tile, *scene.Render(scene.frame().TileBounds(tile), {}, range, nullptr)));
      begin = range.end();
    }
  }
  EXPECT_TRUE(merger.Complete());
  return merger.Picture();
}

// What brute force knows: a line per sample with its filter weight and what it hit.
inline std::string EverySample(const Scene& scene) {
  const FrameSpec& frame = scene.frame();
  const ChannelLayout layout = frame.Layout();
  std::string text;
  for (uint32_t s = 0; s < frame.samples_per_pixel; ++s) {
    const RadianceTile tile = *scene.Render(frame.crop, {}, {s, 1}, nullptr);
    const auto pixels = static_cast<size_t>(frame.crop.area());
    IdReader ids(layout.shape(), pixels, tile.sums);
    for (size_t p = 0; p < pixels; ++p) {
      const float* record = &tile.sums[p * layout.shape().stride()];
      const auto width = static_cast<size_t>(frame.crop.width());
      text += fmt::format("{} {} {}", p % width, p / width, record[layout.weight()]);
      for (size_t set = 0; set < kMatteCount; ++set) {
        for (const IdWeight& hit : ids.Next(record[layout.shape().stride() - kMatteCount + set])) {
          EXPECT_EQ(hit.weight, record[layout.weight()]);
          text += fmt::format(" {}={:08x}", kMatteLayers[set], std::bit_cast<uint32_t>(hit.id));
        }
      }
      text += "\n";
    }
  }
  return text;
}

// A pixel of strips: `wide` of them cover 3/5 if there are any, and `narrow` the rest.
inline std::string StripsInOnePixel(int wide, int narrow) {
  std::string text = R"(
Camera "orthographic"
Film "rgb" "integer xresolution" 1 "integer yresolution" 1
PixelFilter "box"
Sampler "independent" "integer pixelsamples" 2048
WorldBegin
LightSource "infinite"
)";
  float left = -1;
  const float wide_share = wide > 0 ? 0.6f : 0;
  for (int i = 0; i < wide + narrow; ++i) {
    const float share =
        i < wide ? wide_share / static_cast<float>(wide) : (1 - wide_share) / static_cast<float>(narrow);
    const float right = left + 2 * share;
    text += fmt::format("Shape \"bilinearmesh\" \"point3 P\" [ {0} -1 1 {1} -1 1 {0} 1 1 {1} 1 1 ]\n", left,
                        right);
    left = right;
  }
  return text;
}

// How many samples of the only pixel of a frame hit each object.
inline std::map<float, uint32_t> HitsByObject(const Scene& scene) {
  std::map<float, uint32_t> hits;
  for (uint32_t s = 0; s < scene.frame().samples_per_pixel; ++s) {
    const RadianceTile tile = *scene.Render(scene.frame().crop, {}, {s, 1}, nullptr);
    ++hits[tile.sums[tile.sums.size() - 2]];
  }
  return hits;
}

class Mattes : public testing::Test {
 protected:
  Mattes() {
    std::string name = (std::filesystem::temp_directory_path() / "mattes-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
    folder_ = name;
  }
  ~Mattes() override { std::filesystem::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return (folder_ / name).string();
  }
  // Runs a script of tests/picture with the standard library of Python alone. Returns its output, or what it
  // complains about after "failed: ".
  std::string Python(const std::string& script, const std::string& arguments) const {
    const std::string log = (folder_ / "log").string();
    const int code = std::system(
        fmt::format("python3 -B {}/tests/picture/{} {} >{} 2>&1", SourceDir(), script, arguments, log)
            .c_str());
    std::ifstream file(log);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    return (code == 0 ? "" : "failed: ") + text;
  }

  std::filesystem::path folder_;
};

}  // namespace tessera
