// Groups of lights: who is in which, and that their layers sum to the picture.
#include "renderer/scene/light_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/renderer/scene/layer_scenes.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// Four lights: two with a group, and one whose emitter is a mesh of two primitives.
constexpr const char* kLitStage = R"(
LookAt 0 1 -5  0 0.5 0  0 1 0
Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "bool savefp16" false "float maxcomponentvalue" 3
PixelFilter "mitchell"
Camera "perspective" "float fov" 40
Sampler "independent"
WorldBegin
LightSource "infinite" "rgb L" [ 0.2 0.3 0.4 ] "string group" "sky"
LightSource "point" "point3 from" [ 2 4 -3 ] "rgb I" [ 20 18 15 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 5 4 3 ] "string group" "key"
  Material "diffuse"
  Translate -1 1.6 0
  Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
  MakeNamedMaterial "lamp" "string type" "diffuse"
  NamedMaterial "lamp"
  AreaLightSource "diffuse" "rgb L" [ 9 9 9 ] "bool twosided" true
  Translate 1 2 0
  Shape "trianglemesh" "string name" "bulb" "point3 P" [ 0 0 0  0.5 0 0  0 0.5 0  0.5 0.5 0 ] "integer indices" [ 0 1 2  1 3 2 ]
AttributeEnd
Material "coateddiffuse" "rgb reflectance" [ 0.6 0.4 0.2 ] "float roughness" 0.3
Shape "bilinearmesh" "point3 P" [ -9 0 -9  9 0 -9  -9 0 9  9 0 9 ]
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [ 1 1 1 ] "rgb Le" [ 0.1 0.1 0.1 ]
MediumInterface "fog" ""
Material "interface"
Translate 0 0.5 -2
Shape "sphere" "float radius" 0.4
)";

std::unique_ptr<Scene> LoadGrouped(const std::string& text, const std::vector<LightGroupRule>& rules,
                                   const std::set<std::string>& layers, std::string* error = nullptr) {
  MemoryFiles files({{"scene.pbrt", text}});
  RenderOptions options;
  options.aovs = layers;
  options.light_groups = rules;
  options.samples_per_pixel = kLayerSamples;
  auto scene = Scene::Load(files, "scene.pbrt", options, Scene::Depth::kRender);
  if (!scene && error != nullptr) *error = scene.error().message;
  return scene ? std::move(*scene) : nullptr;
}

float Total(const Scene& scene, const RadianceTile& tile, const std::string& channel) {
  const ChannelLayout layout = scene.frame().Layout();
  float sum = 0;
  for (size_t pixel = 0; pixel < 16; ++pixel)
    sum += tile.sums[pixel * layout.shape().stride() + *layout.SlotOf(channel)];
  return sum;
}

std::set<std::string> LightLayers(const Scene& scene) {
  std::set<std::string> layers;
  for (const Channel& channel : scene.frame().channels) {
    if (channel.name.starts_with("light_")) layers.insert(channel.name.substr(0, channel.name.rfind('.')));
  }
  return layers;
}

TEST(LightGroups, LayersSumToThePictureInEveryPixel) {
  for (const char* integrator : {"path", "volpath", "simplepath"}) {
    const std::string text =
        std::string("Integrator \"") + integrator + "\" \"integer maxdepth\" 5\n" + kLitStage;
    const auto scene = LoadGrouped(text, {}, {"light_groups"});
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(LightLayers(*scene), (std::set<std::string>{"light_key", "light_others", "light_sky"}));
    const RadianceTile tile = Rendered(*scene);
    const ChannelLayout layout = scene->frame().Layout();
    for (size_t pixel = 0; pixel < 16; ++pixel) {
      for (const char* component : {"R", "G", "B"}) {
        const auto value = [&](const std::string& layer) {
          return tile.sums[pixel * layout.shape().stride() + *layout.SlotOf(layer + component)];
        };
        const float sum = value("light_key.") + value("light_others.") + value("light_sky.");
        EXPECT_NEAR(sum, value(""), 2e-5f * std::abs(value("")) + 1e-4f) << integrator;
      }
    }
    for (const char* layer : {"light_key.R", "light_others.R", "light_sky.R"})
      EXPECT_GT(Total(*scene, tile, layer), 0) << integrator << layer;
  }
}

// A layer of a group is the picture of a scene with its lights alone.
TEST(LightGroups, ALayerIsThePictureOfItsLights) {
  const std::string start = "Integrator \"path\" \"integer maxdepth\" 3\n";
  std::string text = start + kLitStage;
  text.replace(text.find("\"float maxcomponentvalue\" 3"), 27, "");
  const auto all = LoadGrouped(text, {}, {"light_groups"});
  std::string dark = text;
  dark.replace(dark.find("[ 0.2 0.3 0.4 ]"), 15, "[ 0 0 0 ]");
  dark.replace(dark.find("[ 20 18 15 ]"), 12, "[ 0 0 0 ]");
  dark.replace(dark.find("[ 9 9 9 ]"), 9, "[ 0 0 0 ]");
  const auto key = LoadGrouped(dark, {}, {});
  ASSERT_TRUE(all && key);
  const float expected = Total(*key, Rendered(*key), "G");
  EXPECT_NEAR(Total(*all, Rendered(*all), "light_key.G"), expected, 0.05f * expected);
}

TEST(LightGroups, RulesOfTheCommandLineComeFirstAndTheFirstOfThemDecides) {
  struct Case {
    std::vector<LightGroupRule> rules;
    std::set<std::string> layers;
  };
  const Case cases[] = {
      {{{"rim", "point"}}, {"light_sky", "light_rim", "light_key", "light_others"}},
      {{{"rim", "area"}, {"warm", "*"}}, {"light_warm", "light_rim", "light_others"}},
      {{{"lamps", "la?p"}}, {"light_sky", "light_key", "light_lamps", "light_others"}},
      {{{"bulbs", "bulb"}}, {"light_sky", "light_key", "light_bulbs", "light_others"}},
      {{{"file", "scene.pbrt:*"}}, {"light_file", "light_others"}},
      {{{"others", "*"}}, {"light_others"}},
      // The same group twice is one group.
      {{{"key", "point"}, {"key", "lamp"}}, {"light_sky", "light_key", "light_others"}},
  };
  for (const Case& c : cases) {
    const auto scene = LoadGrouped(kLitStage, c.rules, {});
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(LightLayers(*scene), c.layers) << c.rules.front().group;
  }
}

TEST(LightGroups, CostNothingUnlessTheyAreAskedFor) {
  EXPECT_EQ(LoadGrouped(kLitStage, {}, {})->frame().channels.size(), 4u);
  EXPECT_EQ(LightLayers(*LoadGrouped(kLitStage, {}, {"all"})).size(), 3u);
  EXPECT_EQ(LightLayers(*LoadWith(kBall, {"all"})).size(), 0u) << "no light has a group";
}

TEST(LightGroups, PatternsThatMatchNothingAreAWarning) {
  const auto scene = LoadGrouped(kLitStage, {{"rim", "spot*"}}, {});
  ASSERT_NE(scene, nullptr);
  std::string warnings;
  for (const std::string& warning : scene->summary().warnings) warnings += warning + "\n";
  EXPECT_THAT(warnings, HasSubstr("--light-group rim=spot*: no light matches"));
  EXPECT_THAT(warnings, HasSubstr("area, infinite, point"));
}

TEST(LightGroups, NamesThatNoLayerCanHaveAreRefusedWithTheirPlace) {
  for (const std::string name : {"", "a.b", "key light", "schl\xc3\xbcssel", "a\tb"}) {
    EXPECT_FALSE(CheckLightGroupName(name)) << name;
    std::string text = kLitStage, error;
    text.replace(text.find("\"sky\""), 5, "\"" + name + "\"");
    EXPECT_EQ(LoadGrouped(text, {}, {}, &error), nullptr);
    EXPECT_THAT(error, HasSubstr("scene.pbrt:8:")) << name;
    EXPECT_THAT(error, HasSubstr("cannot be the name of a light group"));
  }
  EXPECT_FALSE(CheckLightGroupName(std::string(kLightGroupNameMax + 1, 'a')));
  EXPECT_TRUE(CheckLightGroupName(std::string(kLightGroupNameMax, 'a')));
  for (const char* rule : {"key", "=point", "key=", "ke y=point", "key=a\tb"})
    EXPECT_FALSE(ParseLightGroupRule(rule));
  const auto rule = ParseLightGroupRule("key=a=b");
  ASSERT_TRUE(rule);
  EXPECT_EQ(*rule, (LightGroupRule{"key", "a=b"}));
}

TEST(LightGroups, MoreGroupsThanALimitAreRefused) {
  std::string text = kBall, lights;
  for (size_t i = 0; i < kLightGroupsMax; ++i)
    lights += "LightSource \"point\" \"string group\" \"g" + std::to_string(i) + "\"\n";
  text.insert(text.find("LightSource"), lights);
  std::string error;
  EXPECT_EQ(LoadGrouped(text, {}, {}, &error), nullptr);
  EXPECT_THAT(error, HasSubstr("light groups, expected at most"));
  // One less has 3 channels each, and too many with every other layer.
  text = kBall;
  lights.resize(lights.rfind("LightSource"));
  text.insert(text.find("LightSource"), lights);
  EXPECT_NE(LoadGrouped(text, {}, {"light_groups"}), nullptr);
  EXPECT_EQ(LoadGrouped(text, {}, {"all"}, &error), nullptr);
  EXPECT_THAT(error, HasSubstr("256 channels"));
}

TEST(LightGroups, PatternsKnowStarsAndQuestionMarks) {
  struct Case {
    const char *pattern, *text;
    bool matches;
  };
  const Case cases[] = {{"*", "", true},       {"", "", true},         {"", "a", false},
                        {"a*c", "abbc", true}, {"a*c", "abcb", false}, {"?", "a", true},
                        {"?", "", false},      {"*b*", "abc", true},   {"**a", "bba", true},
                        {"a?c*", "abc", true}, {"abc", "ab", false},   {"*ab", "aab", true}};
  for (const Case& c : cases)
    EXPECT_EQ(MatchesPattern(c.pattern, c.text), c.matches) << c.pattern << " " << c.text;
}

TEST(LightGroups, OptionsKeepRulesInTheirOrder) {
  RenderOptions options;
  options.light_groups = {{"key", "b=*"}, {"a", "\xc3\xbc ,;"}, {"key", "area"}};
  const auto decoded = DecodeRenderOptions(EncodeRenderOptions(options));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(*decoded, options);
  options.light_groups.assign(
      kLightGroupsMax, {std::string(kLightGroupNameMax, 'g'), std::string(kLightGroupPatternMax, '*')});
  EXPECT_TRUE(DecodeRenderOptions(EncodeRenderOptions(options)));
  for (const char* bad :
       {"light-group=\n", "light-group=key\n", "light-group=a.b=c\n", "light-group=a=b\t\n"})
    EXPECT_FALSE(DecodeRenderOptions(bad)) << bad;
}

}  // namespace
}  // namespace tessera
