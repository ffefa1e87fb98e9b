#include "renderer/denoise/oidn_denoiser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "renderer/denoise/denoise.h"
#include "renderer/denoise/finished_picture.h"
#include "tests/build_paths.h"
#include "tests/renderer/denoise/noisy_picture.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string FileOf(const std::string& variant) {
  return BinaryDir() + "/tests/oidn/" + variant +
         (variant == "former" ? "/libOpenImageDenoise.so.1" : "/libOpenImageDenoise.so.2");
}

LoadedPicture SmallPicture() {
  LoadedPicture picture = Rendered(6, 4, 0.5f, [](int x, int) {
    return Point{2, 0.5f, x < 3 ? 0.0f : 0.6f};
  });
  // Its network needs neither.
  for (std::string& channel : picture.channels) {
    if (channel == "depth.Z" || channel == "halves.G") channel = "x." + channel;
  }
  return picture;
}

Result<LoadedPicture> DenoisedBy(const std::string& variant, const LoadedPicture& picture,
                                 const std::stop_token& stop = {}) {
  const auto library = oidn::LoadFrom(FileOf(variant));
  if (!library) return library.error();
  const auto layers = FindInputLayers(picture, "p.exr", Denoiser::kOidn);
  if (!layers) return layers.error();
  const auto colors = DenoiseWithOidn(*library, picture, *layers, "p.exr", 2, stop);
  if (!colors) return colors.error();
  return WithColors(picture, *layers, *colors);
}

TEST(OidnDenoiser, GivesTheLibraryColoursAlbedoAndNormals) {
  for (const auto& [variant, version] : {std::pair{"new", "oidn 2.3.3"}, {"former", "oidn 1.4.3"}}) {
    LoadedPicture noisy = SmallPicture();
    Value(noisy, "G", 2, 2) = std::numeric_limits<float>::quiet_NaN();
    Value(noisy, "B", 2, 2) = std::numeric_limits<float>::infinity();
    auto denoised = DenoisedBy(variant, noisy);
    ASSERT_TRUE(denoised) << denoised.error().message;
    EXPECT_EQ(denoised->attributes.at(kDenoiserAttribute), version);
    for (const auto& [color, axis] : {std::pair{"R", "X"}, {"G", "Y"}, {"B", "Z"}}) {
      const float expected = 0.5f * Value(noisy, color, 4, 3) +
                             Value(noisy, std::string("albedo.") + color, 4, 3) +
                             0.25f * Value(noisy, std::string("normal.") + axis, 4, 3);
      EXPECT_FLOAT_EQ(Value(*denoised, color, 4, 3), expected);
      EXPECT_EQ(Value(*denoised, std::string("noisy.") + color, 4, 3), Value(noisy, color, 4, 3));
    }
    EXPECT_EQ(Value(*denoised, "R", 0, 0), Value(noisy, "R", 0, 0)) << "the library left no number there";
    EXPECT_FLOAT_EQ(Value(*denoised, "G", 2, 2), Value(noisy, "albedo.G", 2, 2));
    EXPECT_GT(Value(*denoised, "B", 2, 2), 1000);
  }
}

TEST(OidnDenoiser, NamesWhatIsWrongWithALibrary) {
  const std::pair<const char*, const char*> cases[] = {
      {"incomplete", "lacks the function oidnExecuteFilter of Open Image Denoise; install"},
      {"next_version",
       "p.exr: the Open Image Denoise that is installed has version 3.0.0, expected 1.4 to 2"},
      {"without_device", "p.exr: Open Image Denoise cannot be started: the processor lacks?what is needed"},
      {"failing", "p.exr: Open Image Denoise failed: error 4"},
      {"that_is_missing", "Open Image Denoise cannot be loaded ("},
  };
  for (const auto& [variant, message] : cases) {
    const auto denoised = DenoisedBy(variant, SmallPicture());
    ASSERT_FALSE(denoised) << variant;
    EXPECT_EQ(denoised.error().kind, ErrorKind::kFailed);
    EXPECT_THAT(denoised.error().message, HasSubstr(message)) << variant;
  }
}

TEST(OidnDenoiser, StopsWhenAskedTo) {
  std::stop_source stop;
  stop.request_stop();
  const auto denoised = DenoisedBy("new", SmallPicture(), stop.get_token());
  ASSERT_FALSE(denoised);
  EXPECT_EQ(denoised.error().kind, ErrorKind::kInterrupted);
}

TEST(OidnDenoiser, SaysWhatToInstallWhereThereIsNoLibrary) {
  if (oidn::Load()) GTEST_SKIP() << "Open Image Denoise is installed";
  const auto denoised = Denoise(SmallPicture(), "p.exr", 1, {}, Denoiser::kOidn);
  ASSERT_FALSE(denoised);
  EXPECT_THAT(denoised.error().message,
              AllOf(HasSubstr("p.exr: Open Image Denoise cannot be loaded (libOpenImageDenoise.so.2"),
                    HasSubstr("install Open Image Denoise 1.4 or 2"), HasSubstr("--denoiser regression")));
  EXPECT_FALSE(CheckInstalled(Denoiser::kOidn));
  EXPECT_TRUE(CheckInstalled(Denoiser::kRegression));
}

TEST(OidnDenoiser, NamesTheLayersThatAreMissing) {
  LoadedPicture picture = SmallPicture();
  std::ranges::replace(picture.channels, "normal.Z", "x.Z");
  EXPECT_EQ(CheckDenoisable(picture, "p.exr", Denoiser::kOidn).error().message,
            "p.exr: cannot be denoised without the layer normal; render it with --aov denoise");
}

}  // namespace
}  // namespace tessera
