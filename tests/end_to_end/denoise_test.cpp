// tessera denoise, on pictures, sequences and groups of lights.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <utility>
#include <vector>

#include "renderer/film/picture_file.h"
#include "tests/end_to_end/denoised_pictures.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// Spheres on a floor that a camera passes.
constexpr const char* kPassing = R"(
Film "rgb" "integer xresolution" 64 "integer yresolution" 48
Sampler "zsobol" "integer pixelsamples" 16
TransformTimes 0 1
ActiveTransform EndTime Translate 0.7 0 0 ActiveTransform All
LookAt 0 2 -6  0 0.5 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 9 8 7 ]
  Translate -2 3 -1 Shape "sphere" "float radius" 0.4
AttributeEnd
Texture "squares" "spectrum" "checkerboard" "float uscale" 9 "float vscale" 9
  "rgb tex1" [ 0.8 0.7 0.6 ] "rgb tex2" [ 0.1 0.1 0.2 ]
Material "diffuse" "texture reflectance" "squares"
Shape "bilinearmesh" "point3 P" [ -5 0 -5  5 0 -5  -5 0 5  5 0 5 ]
Material "diffuse" "rgb reflectance" [ 0.7 0.3 0.2 ]
Translate -0.6 0.6 0 Shape "sphere" "float radius" 0.6
Translate 1.4 0 0.5 Shape "sphere" "float radius" 0.6
)";

// The mean change of the colours along the vectors of the layer "motion", in frames 0 to 4 of a sequence.
class FlickerMeter {
 public:
  explicit FlickerMeter(std::vector<LoadedPicture> frames) : frames_(std::move(frames)) {}

  double Mean() const {
    double sum = 0;
    int count = 0;
    for (size_t f = 0; f + 1 < frames_.size(); ++f) {
      for (int y = 0; y < frames_[f].height; ++y) {
        for (int x = 0; x < frames_[f].width; ++x) {
          const double to_x = x + At(f, "motion.X", x, y), to_y = y + At(f, "motion.Y", x, y);
          if (to_x < 0 || to_y < 0 || to_x > frames_[f].width - 2 || to_y > frames_[f].height - 2) continue;
          sum += std::abs(Between(f + 1, to_x, to_y) - At(f, "G", x, y));
          ++count;
        }
      }
    }
    return sum / count;
  }

 private:
  double At(size_t frame, const std::string& channel, int x, int y) const {
    const LoadedPicture& picture = frames_[frame];
    const auto c = std::ranges::find(picture.channels, channel) - picture.channels.begin();
    return picture.values[static_cast<size_t>(y * picture.width + x) * picture.channels.size() +
                          static_cast<size_t>(c)];
  }
  double Between(size_t frame, double x, double y) const {
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const double right = x - x0, down = y - y0;
    return (1 - down) * ((1 - right) * At(frame, "G", x0, y0) + right * At(frame, "G", x0 + 1, y0)) +
           down * ((1 - right) * At(frame, "G", x0, y0 + 1) + right * At(frame, "G", x0 + 1, y0 + 1));
  }

  const std::vector<LoadedPicture> frames_;
};

TEST_F(DenoisedPictures, ASequenceFlickersLessIfItsFramesAreDenoisedTogether) {
  Write("passing.pbrt", kPassing);
  const std::vector<std::string> range{"--frames", "0-4"};
  const Outcome rendered = Tessera(
      With({"render", "passing.pbrt", "--fps", "10", "-o", "noisy.#.exr", "--in-process", "--aov", "denoise"},
           range));
  ASSERT_EQ(rendered.code, 0) << rendered.errors;
  const Outcome alone =
      Tessera(With({"denoise", "noisy.#.exr", "-o", "alone.#.exr", "--no-temporal"}, range));
  ASSERT_EQ(alone.code, 0) << alone.errors;
  const Outcome together =
      Tessera(With({"denoise", "noisy.#.exr", "-o", "together.#.exr", "--threads", "1"}, range));
  ASSERT_EQ(together.code, 0) << together.errors;
  const auto flicker = [&](const std::string& name) {
    std::vector<LoadedPicture> frames;
    for (int f = 0; f < 5; ++f) frames.push_back(Loaded(name + "." + std::to_string(f) + ".exr"));
    return FlickerMeter(std::move(frames)).Mean();
  };
  RecordProperty("noisy", std::to_string(flicker("noisy")));
  RecordProperty("alone", std::to_string(flicker("alone")));
  RecordProperty("together", std::to_string(flicker("together")));
  EXPECT_LT(flicker("alone"), 0.8 * flicker("noisy"));
  // Half of what is left is the meter's, which interpolates the edges of the texture.
  EXPECT_LT(flicker("together"), 0.95 * flicker("alone"));
  EXPECT_LT(flicker("together"), 0.6 * flicker("noisy"));
  const Outcome again =
      Tessera(With({"denoise", "noisy.#.exr", "-o", "again.#.exr", "--threads", "3"}, range));
  ASSERT_EQ(again.code, 0) << again.errors;
  EXPECT_TRUE(Bytes("again.2.exr") == Bytes("together.2.exr"));
}

TEST_F(DenoisedPictures, ASequenceIsDenoisedUpToAFrameThatIsMissing) {
  Oracle(BoxScene(), {"--spp", "8", "--aov", "denoise"});
  for (const char* frame : {"1", "2"})
    std::filesystem::copy_file(Path("oracle.exr"), Path("shot." + std::string(frame) + ".exr"));
  const Outcome outcome = Tessera({"denoise", "shot.#.exr", "--frames", "1-3", "-o", "clean.#.exr"});
  EXPECT_NE(outcome.code, 0);
  EXPECT_THAT(outcome.errors, HasSubstr("shot.3.exr"));
  EXPECT_TRUE(Exists("clean.1.exr") && Exists("clean.2.exr") && !Exists("clean.3.exr")) << outcome.errors;
}

TEST_F(DenoisedPictures, AFullDiskLeavesTheFormerPicture) {
  Oracle(BoxScene(), {"--spp", "8", "--aov", "denoise"});
  Write("clean.exr", "the former picture");
  // No file of the process may grow beyond 4 KB.
  const Outcome outcome =
      RunShell(folder(), "trap '' XFSZ; ulimit -f 4; $tessera denoise oracle.exr -o clean.exr");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("clean.exr"));
  EXPECT_EQ(Bytes("clean.exr"), "the former picture");
  for (const auto& each : std::filesystem::directory_iterator(folder())) {
    const std::string name = each.path().filename();
    EXPECT_TRUE(name == "clean.exr" || name.find("clean") == std::string::npos) << name << " is left";
  }
}

TEST_F(DenoisedPictures, DamagedAndHostileFilesAreRefusedByName) {
  const std::string good = Oracle(BoxScene(), {"--spp", "8", "--aov", "denoise"});
  std::string huge = good;
  const size_t window = huge.find(std::string("dataWindow\0box2i\0", 17));
  ASSERT_NE(window, std::string::npos);
  // The right and lower edges, after the name, the type, the size and the other edges.
  huge.replace(window + 17 + 4 + 8, 8, std::string("\x60\xea\0\0\x60\xea\0\0", 8));
  const std::pair<const char*, std::string> files[] = {{"empty.exr", ""},
                                                       {"cut.exr", good.substr(0, good.size() / 2)},
                                                       {"huge.exr", huge},
                                                       {"text.exr", "not a picture"}};
  for (const auto& [name, bytes] : files) {
    Write(name, bytes);
    const Outcome refused = Tessera({"denoise", name, "-o", "clean.exr"});
    EXPECT_EQ(refused.code, 2) << name << refused.errors;
    EXPECT_THAT(refused.errors, HasSubstr(name));
    EXPECT_FALSE(Exists("clean.exr")) << name;
  }
  EXPECT_EQ(Tessera({"denoise", "missing.exr", "-o", "clean.exr"}).code, 2);
}

TEST_F(DenoisedPictures, DenoisedGroupsOfLightsAreMixed) {
  const Outcome rendered = Tessera({"render", BoxScene(), "-o", "noisy.exr", "--aov", "denoise", "--spp", "8",
                                    "--light-group", "key=*", "--exr-type", "float", "--workers", "2"});
  ASSERT_EQ(rendered.code, 0) << rendered.errors;
  const Outcome denoised = Tessera({"denoise", "noisy.exr", "-o", "lit.exr"});
  ASSERT_EQ(denoised.code, 0) << denoised.errors;
  const Outcome mixed =
      Tessera({"relight", "lit.exr", "-o", "mixed.exr", "--gain", "key=1", "--exr-type", "float"});
  ASSERT_EQ(mixed.code, 0) << mixed.errors;
  EXPECT_EQ(Tessera({"compare", "mixed.exr", "lit.exr", "--layer", "RGB", "--tolerance", "1e-4"}).code, 0);
  const Outcome dark =
      Tessera({"relight", "lit.exr", "-o", "dark.exr", "--gain", "key=0", "--exr-type", "float"});
  ASSERT_EQ(dark.code, 0) << dark.errors;
  EXPECT_NE(Tessera({"compare", "dark.exr", "lit.exr", "--layer", "RGB", "--tolerance", "1e-4"}).code, 0);
}

// A library of the tests stands for Open Image Denoise.
TEST_F(DenoisedPictures, UseOpenImageDenoiseWhereItIsInstalled) {
  Oracle(BoxScene(), {"--spp", "8", "--aov", "denoise"});
  const std::vector<std::string> command{"denoise", "oracle.exr", "-o", "clean.exr", "--denoiser", "oidn"};
  const Outcome missing = Tessera(command);
  if (missing.code == 0) GTEST_SKIP() << "Open Image Denoise is installed";
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.errors, HasSubstr("install Open Image Denoise 1.4 or 2"));
  EXPECT_FALSE(Exists("clean.exr"));
  ASSERT_EQ(::setenv("LD_LIBRARY_PATH", (BinaryDir() + "/tests/oidn/new").c_str(), 1), 0);
  const Outcome outcome = Tessera(command);
  ::unsetenv("LD_LIBRARY_PATH");
  ASSERT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_EQ(Loaded("clean.exr").attributes.at("tessera:denoiser"), "oidn 2.3.3");
}

TEST_F(DenoisedPictures, KeepTheirTypesAndAreDenoisedOnce) {
  Oracle(BoxScene(), {"--spp", "16", "--aov", "denoise"});
  const Outcome outcome = Tessera({"denoise", "oracle.exr", "-o", "clean.exr", "--threads", "1"});
  ASSERT_EQ(outcome.code, 0) << outcome.errors;
  const LoadedPicture clean = Loaded("clean.exr");
  for (size_t c = 0; c < clean.channels.size(); ++c) {
    const bool is_color = clean.channels[c].size() == 1 || clean.channels[c].starts_with("noisy.");
    EXPECT_EQ(clean.types[c], is_color ? ExrType::kHalf : ExrType::kFloat) << clean.channels[c];
  }
  ASSERT_EQ(Tessera({"denoise", "clean.exr", "-o", "twice.exr", "--threads", "3"}).code, 0);
  EXPECT_TRUE(Bytes("twice.exr") == Bytes("clean.exr"));
  ASSERT_EQ(Tessera({"denoise", "oracle.exr", "-o", "parts.exr", "--aov-split", "--compression", "piz"}).code,
            0);
  for (const char* part : {"parts.exr", "parts.noisy.exr", "parts.albedo.exr"})
    EXPECT_TRUE(Exists(part)) << part;
  EXPECT_EQ(Tessera({"denoise", "oracle.exr", "-o", "clean.exr", "--no-clobber"}).code, 2);
}

}  // namespace
}  // namespace tessera
