// Layers of light, of its shadows and of its noise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "renderer/film/tile_painter.h"
#include "tests/renderer/scene/layer_scenes.h"

namespace tessera {
namespace {

TEST(LightLayers, PartsOfTheLightSumToThePictureInEveryPixel) {
  for (const char* integrator : {"path", "volpath", "mixture", "simplepath", "simplevolpath", "randomwalk"}) {
    const auto scene = LoadWith(StageFor(integrator), {"all"});
    const RadianceTile tile = Rendered(*scene);
    const ChannelLayout layout = scene->frame().Layout();
    float lobes_total = 0;
    for (size_t pixel = 0; pixel < 16; ++pixel) {
      for (const char* component : {"R", "G", "B"}) {
        const auto value = [&](const std::string& layer) {
          return tile.sums[pixel * layout.shape().stride() + *layout.SlotOf(layer + component)];
        };
        const float whole = value("");
        EXPECT_NEAR(value("emission.") + value("direct.") + value("indirect."), whole, 1e-5f * whole + 1e-5f)
            << integrator;
        for (const std::string order : {"direct", "indirect"}) {
          float lobes = 0;
          for (const char* lobe : {"_diffuse.", "_specular.", "_transmission.", "_volume."}) {
            EXPECT_GE(value(order + lobe), -1e-3f);
            lobes += value(order + lobe);
          }
          EXPECT_NEAR(lobes, value(order + "."), 1e-5f * whole + 1e-5f) << integrator;
          lobes_total += lobes;
        }
      }
    }
    EXPECT_GT(lobes_total, 0) << integrator;
  }
}

// All light of a scene with one kind of surface is in one lobe.
TEST(LightLayers, LobesAreThoseOfTheFirstSurface) {
  struct Case {
    const char* material;
    const char* lobe;
  };
  const Case cases[] = {
      {"\"diffuse\"", "diffuse"},
      {"\"conductor\"", "specular"},
      {"\"conductor\" \"float roughness\" 0.4", "specular"},
      {"\"thindielectric\" \"float eta\" 1.0001", "transmission"},
      {"\"diffusetransmission\" \"rgb reflectance\" [ 0 0 0 ]", "transmission"},
  };
  for (const Case& c : cases) {
    std::string text = kBall;
    const size_t material = text.find("Material");
    text.replace(material, text.find('\n', material) - material, std::string("Material ") + c.material);
    const auto scene = LoadWith(text, {"all"});
    const RadianceTile tile = Rendered(*scene);
    float all = 0, own = 0;
    for (const char* order : {"direct", "indirect"}) {
      all += Held(*scene, tile, std::string(order) + ".G");
      own += Held(*scene, tile, std::string(order) + "_" + c.lobe + ".G");
    }
    EXPECT_GT(all, 0) << c.material;
    EXPECT_NEAR(own, all, 0.001f * all) << c.material;
  }
}

// The mean of a channel over all pixels of the tile.
float MeanOfAll(const Scene& scene, const RadianceTile& tile, const std::string& channel) {
  const ChannelLayout layout = scene.frame().Layout();
  const size_t pixels = static_cast<size_t>(tile.bounds.width()) * static_cast<size_t>(tile.bounds.height());
  float sum = 0, weight = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const float* const record = &tile.sums[i * layout.shape().stride()];
    sum += record[*layout.SlotOf(channel)];
    weight += record[*layout.SlotOf("W")];
  }
  return sum / weight;
}

TEST(LightLayers, ACoatReflectsSpecularlyAndItsBaseDiffusely) {
  // The same surface without its base has the specular part alone.
  struct Case {
    const char* layer;
    // Relative. Which part of the light a base below a scattering layer sends is only estimated.
    float tolerance;
  };
  for (const Case& c : {Case{"", 0.05f}, Case{" \"rgb albedo\" [ 0.3 0.3 0.3 ] \"float g\" 0.2", 0.2f}}) {
    const auto mean = [&](const char* reflectance, const std::string& channel) {
      std::string text = kBall;
      const size_t material = text.find("Material");
      text.replace(material, text.find('\n', material) - material,
                   std::string("Material \"coateddiffuse\" \"float roughness\" 0.3 \"rgb reflectance\" ") +
                       reflectance + c.layer);
      const auto scene = LoadWith(text, {"all"});
      return MeanOfAll(*scene, Rendered(*scene), channel);
    };
    const float specular = mean("[ 0.5 0.5 0.5 ]", "direct_specular.G");
    const float diffuse = mean("[ 0.5 0.5 0.5 ]", "direct_diffuse.G");
    EXPECT_GT(specular, 0.01f);
    EXPECT_GT(diffuse, 5 * specular);
    EXPECT_NEAR(specular, mean("[ 0 0 0 ]", "direct_specular.G"), c.tolerance * specular) << c.layer;
  }
}

// A point light above a plane, with a disk in between.
TEST(LightLayers, ShadowIsTheLightThatIsMissing) {
  const std::string plane = R"(
LookAt 0 3 -0.01  0 0 0  0 1 0
Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "bool savefp16" false
PixelFilter "box"
Camera "perspective" "float fov" 10
WorldBegin
LightSource "point" "point3 from" [ 0 20 0 ] "rgb I" [ 400 400 400 ]
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "bilinearmesh" "point3 P" [ -1 0 -1  1 0 -1  -1 0 1  1 0 1 ]
)";
  const std::string blocked =
      plane + "Rotate -90 1 0 0\nShape \"disk\" \"float radius\" 4 \"float height\" 10\n";
  for (const char* integrator : {"path", "volpath", "simplepath"}) {
    const std::string start = std::string("Integrator \"") + integrator + "\" \"integer maxdepth\" 1\n";
    const auto lit = LoadWith(start + plane, {"shadow"}), dark = LoadWith(start + blocked, {"shadow"});
    const RadianceTile lit_tile = Rendered(*lit), dark_tile = Rendered(*dark);
    EXPECT_EQ(Held(*lit, lit_tile, "shadow.G"), 0) << integrator;
    EXPECT_EQ(Held(*dark, dark_tile, "G"), 0) << integrator;
    EXPECT_GT(Held(*lit, lit_tile, "G"), 0);
    EXPECT_NEAR(Held(*dark, dark_tile, "shadow.G"), Held(*lit, lit_tile, "G"),
                0.02f * Held(*lit, lit_tile, "G"));
  }
}

TEST(LightLayers, VarianceIsThatOfTheMean) {
  const auto scene = LoadWith(StageFor("path"), {"variance"});
  const ChannelLayout layout = scene->frame().Layout();
  const auto channels = scene->frame().PictureChannels();
  // From single samples, by the textbook.
  double sum = 0, squares = 0;
  const size_t red = *layout.SlotOf("R"), weight = layout.weight();
  for (uint32_t i = 0; i < kLayerSamples; ++i) {
    const RadianceTile one = *scene->Render({2, 3, 3, 4}, {}, {i, 1}, nullptr);
    const double value = one.sums[red] / one.sums[weight];
    sum += value;
    squares += value * value;
  }
  const double n = kLayerSamples, mean = sum / n;
  const double expected = (squares / n - mean * mean) / (n - 1);
  const RadianceTile all = *scene->Render({2, 3, 3, 4}, {}, {0, kLayerSamples}, nullptr);
  const TilePainter painter(scene->frame().PictureChannels(), layout);
  PixelSource pixel(layout, 1, all.sums, kLayerSamples);
  pixel.Next();
  std::vector<float> painted(channels.size());
  painter.Paint(pixel, painted.data());
  const auto at = std::ranges::find(channels, "variance.R", &PictureChannel::name) - channels.begin();
  EXPECT_GT(expected, 0);
  EXPECT_NEAR(painted[static_cast<size_t>(at)], expected, 1e-3 * expected);
}

// Two independent halves differ by their noise alone.
TEST(LightLayers, HalvesAreTwoPicturesOfHalfTheSamples) {
  const auto scene = LoadWith(StageFor("path"), {"halves"});
  const ChannelLayout layout = scene->frame().Layout();
  double sums[2] = {}, weights[2] = {};
  const size_t red = *layout.SlotOf("R");
  for (uint32_t i = 0; i < kLayerSamples; ++i) {
    const RadianceTile one = *scene->Render({2, 3, 3, 4}, {}, {i, 1}, nullptr);
    sums[i >> 2 & 1] += one.sums[red];
    weights[i >> 2 & 1] += one.sums[layout.weight()];
  }
  const RadianceTile all = *scene->Render({2, 3, 3, 4}, {}, {0, kLayerSamples}, nullptr);
  const float mean = all.sums[red] / all.sums[layout.weight()];
  const float half = all.sums[*layout.SlotOf("halves.R")] / all.sums[layout.weight()];
  EXPECT_NE(half, 0);
  EXPECT_NEAR(mean + half, sums[0] / weights[0], 1e-4);
  EXPECT_NEAR(mean - half, sums[1] / weights[1], 1e-4);
}

}  // namespace
}  // namespace tessera
