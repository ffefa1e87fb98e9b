// Layers of all kinds are bit-identical however they are rendered and whatever fails meanwhile, and groups of
// lights can be mixed afterwards.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <map>

#include "renderer/film/picture_file.h"
#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// What moves, glass, a coat, fog, groups of lights, and a film with channels of its own.
constexpr const char* kEverything = R"(
Film "gbuffer" "integer xresolution" 40 "integer yresolution" 24 "string coordinatesystem" "world"
Sampler "zsobol" "integer pixelsamples" 16
LookAt 0 1 -5  0 0.5 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [ 0.2 0.3 0.4 ] "string group" "sky"
LightSource "point" "point3 from" [ 2 4 -3 ] "rgb I" [ 20 18 15 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 5 4 3 ]
  Translate -1 1.6 0
  Shape "sphere" "float radius" 0.4
AttributeEnd
Material "coateddiffuse" "rgb reflectance" [ 0.6 0.4 0.2 ] "float roughness" 0.3
Shape "bilinearmesh" "point3 P" [ -9 0 -9  9 0 -9  -9 0 9  9 0 9 ]
AttributeBegin
  Material "dielectric"
  ActiveTransform EndTime Translate 0.3 0 0 ActiveTransform All
  Translate 0.7 0.6 -1
  Shape "sphere" "float radius" 0.5
AttributeEnd
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [ 1 1 1 ] "rgb Le" [ 0.1 0.1 0.1 ]
MediumInterface "fog" ""
Material "interface"
Translate 0 0.5 -2
Shape "sphere" "float radius" 0.4
)";

const std::vector<std::string> kAllLayers{"--aov",    "all",           "--light-group",
                                          "key=area", "--light-group", "rim=point"};

class LayersOnFarms : public EndToEnd {
 protected:
  std::string Scene() const { return Write("everything.pbrt", kEverything); }
  static std::vector<std::string> With(std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  // The values of a picture by channel.
  std::map<std::string, std::vector<float>> Channels(const std::string& name) const {
    const auto picture = LoadExr(Path(name));
    EXPECT_TRUE(picture) << picture.error().message;
    std::map<std::string, std::vector<float>> channels;
    for (size_t i = 0; picture && i < picture->values.size(); ++i)
      channels[picture->channels[i % picture->channels.size()]].push_back(picture->values[i]);
    return channels;
  }
};

TEST_F(LayersOnFarms, AreTheSameForAnyNumberOfWorkersAndTiles) {
  const std::string scene = Scene();
  const std::string oracle = Oracle(scene, kAllLayers);
  const std::vector<std::vector<std::string>> ways{
      {"--in-process", "--threads", "3", "--tile-size", "7"},
      {"--workers", "1", "--threads", "1"},
      {"--workers", "1", "--tile-size", "256"},
      {"--workers", "5", "--threads", "1", "--tile-size", "16"},
  };
  for (const auto& way : ways) {
    const Outcome outcome = Tessera(With(With({"render", scene, "-o", "picture.exr"}, way), kAllLayers));
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Bytes("picture.exr") == oracle) << testing::PrintToString(way);
  }
  const auto channels = Channels("picture.exr");
  for (const char* name :
       {"motion.X", "indirect_transmission.R", "direct_volume.R", "variance.G", "P.X", "Variance.B",
        "light_key.R", "light_rim.R", "light_sky.R", "light_others.R", "halves.G", "shadow.G"}) {
    ASSERT_TRUE(channels.contains(name)) << name;
    EXPECT_TRUE(std::ranges::any_of(channels.at(name), [](float value) { return value != 0; })) << name;
  }
}

TEST_F(LayersOnFarms, LeaveTheColoursAsTheyAre) {
  const std::string scene = Scene();
  ASSERT_EQ(Tessera({"render", scene, "-o", "plain.exr", "--in-process"}).code, 0);
  ASSERT_EQ(Tessera(With({"render", scene, "-o", "layers.exr", "--in-process"}, kAllLayers)).code, 0);
  const auto plain = Channels("plain.exr"), layers = Channels("layers.exr");
  for (const char* name : {"R", "G", "B"}) EXPECT_EQ(plain.at(name), layers.at(name)) << name;
}

TEST_F(LayersOnFarms, SurviveKilledWorkersAndCoordinator) {
  const std::string scene = Scene();
  const std::vector<std::vector<std::string>> frames{
      With({"--spp", "512", "--tile-size", "8"}, kAllLayers),
      With({"--spp", "2048", "--noise-threshold", "0.1", "--tile-size", "8"}, kAllLayers)};
  std::vector<std::string> oracles;
  for (const auto& frame : frames) oracles.push_back(Oracle(scene, frame));
  StartCoordinator();
  Process& doomed = StartWorker("doomed");
  StartWorker("steady");
  std::vector<std::string> jobs;
  for (const auto& frame : frames) jobs.push_back(Submit(scene, frame));
  AwaitShare(jobs[0], 0.05);
  doomed.Signal(SIGKILL);
  coordinator().Signal(SIGKILL);
  EXPECT_EQ(coordinator().Wait(), -SIGKILL);
  StartCoordinator();
  for (size_t i = 0; i < jobs.size(); ++i) {
    ASSERT_EQ(Ask({"watch", jobs[i]}).code, 0);
    ASSERT_EQ(Ask({"fetch", jobs[i], "-o", "picture.exr"}).code, 0);
    EXPECT_TRUE(Bytes("picture.exr") == oracles[i]) << i;
  }
}

TEST_F(LayersOnFarms, AreMixedByRelight) {
  const std::string scene = Scene();
  ASSERT_EQ(
      Tessera(With({"render", scene, "-o", "picture.exr", "--in-process", "--exr-type", "float"}, kAllLayers))
          .code,
      0);
  const auto lit = Channels("picture.exr");
  const Outcome mixed = Tessera({"relight", "picture.exr", "-o", "mixed.exr", "--gain", "key=2", "--gain",
                                 "sky=0,1,3", "--exr-type", "float", "--png", "mixed.png"});
  ASSERT_EQ(mixed.code, 0) << mixed.errors;
  const auto result = Channels("mixed.exr");
  for (size_t i = 0; i < lit.at("R").size(); ++i) {
    const auto part = [&](const char* name) { return lit.at(name)[i]; };
    EXPECT_NEAR(part("light_key.G") + part("light_rim.G") + part("light_sky.G") + part("light_others.G"),
                part("G"), 1e-4f * part("G") + 1e-5f);
    EXPECT_NEAR(result.at("R")[i], 2 * part("light_key.R") + part("light_rim.R") + part("light_others.R"),
                1e-4f);
    EXPECT_NEAR(
        result.at("B")[i],
        2 * part("light_key.B") + part("light_rim.B") + 3 * part("light_sky.B") + part("light_others.B"),
        1e-4f);
  }
  EXPECT_EQ(result.at("depth.Z"), lit.at("depth.Z"));
  EXPECT_FALSE(Bytes("mixed.png").empty());
}

TEST_F(LayersOnFarms, WordsThatMeanNothingAreRefused) {
  const std::string scene = Scene();
  ASSERT_EQ(
      Tessera(With({"render", scene, "-o", "picture.exr", "--in-process", "--spp", "1"}, kAllLayers)).code,
      0);
  ASSERT_EQ(Tessera({"render", scene, "-o", "plain.exr", "--in-process", "--spp", "1"}).code, 0);
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"render", scene, "--aov", "albdo"}, "did you mean \"albedo\"?"},
      {{"render", scene, "--light-group", "key"}, "is not NAME=PATTERN"},
      {{"render", scene, "--light-group", "k.y=area"}, "cannot be the name of a light group"},
      {{"render", scene, "-o", "p.png", "--light-group", "key=area"}, "can only be written to an .exr file"},
      {{"relight", "picture.exr", "-o", "m.exr", "--gain", "kye=2"}, "did you mean \"key\"?"},
      {{"relight", "picture.exr", "-o", "m.exr", "--gain", "key=-1"}, "--gain"},
      {{"relight", "picture.exr", "-o", "m.exr", "--gain", "key=1,2"}, "expected one or three"},
      {{"relight", "picture.exr", "-o", "m.exr", "--gain", "key"}, "is not NAME=GAIN"},
      {{"relight", "picture.exr", "-o", "picture.exr"}, "picture.exr"},
      {{"relight", "picture.exr"}, "-o FILE is missing"},
      {{"relight", "plain.exr", "-o", "m.exr", "--gain", "key=2"}, "has no light groups"},
      {{"relight", "missing.exr", "-o", "m.exr"}, "missing.exr"},
  };
  for (const auto& [words, message] : cases) {
    const Outcome outcome = Tessera(words);
    EXPECT_EQ(outcome.code, 2) << testing::PrintToString(words) << outcome.errors;
    EXPECT_THAT(outcome.errors, HasSubstr(message)) << testing::PrintToString(words);
  }
  const Outcome unmatched =
      Tessera({"render", scene, "-o", "p.exr", "--spp", "1", "--in-process", "--light-group", "key=spot"});
  EXPECT_EQ(unmatched.code, 0);
  EXPECT_THAT(unmatched.errors, HasSubstr("--light-group key=spot: no light matches"));
}

}  // namespace
}  // namespace tessera
