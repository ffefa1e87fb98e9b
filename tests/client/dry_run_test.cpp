#include "client/dry_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/build_paths.h"

namespace tessera {
namespace {

using testing::HasSubstr;

SceneOptions Box() {
  SceneOptions options;
  options.path = SourceDir() + "/tests/scenes/box.pbrt";
  options.render.samples_per_pixel = 1000;
  options.render.width = 40;
  options.render.height = 30;
  return options;
}

TEST(Forecast, CountsWhatWouldBeRenderedAndMeasuresAPart) {
  Cancellation cancellation;
  const auto forecast = MakeForecast(Box(), 2, std::chrono::milliseconds(50), cancellation);
  ASSERT_TRUE(forecast) << forecast.error().message;
  EXPECT_EQ(forecast->frames, 1u);
  EXPECT_EQ(forecast->samples, 40u * 30 * 1000);
  EXPECT_FALSE(forecast->is_adaptive);
  EXPECT_GE(forecast->files, 1u);
  EXPECT_GT(forecast->file_bytes, 100u);
  EXPECT_GT(forecast->samples_per_second, 0);
  EXPECT_GT(forecast->seconds(), forecast->load_s);
  EXPECT_GT(forecast->memory_bytes, 1u << 20);
}

TEST(Forecast, CountsAllFramesOfASequence) {
  SceneOptions options = Box();
  options.frames = FrameRange{1, 5, 2};
  options.render.noise_threshold = 0.1;
  Cancellation cancellation;
  const auto forecast = MakeForecast(options, 1, std::chrono::milliseconds(1), cancellation);
  ASSERT_TRUE(forecast) << forecast.error().message;
  EXPECT_EQ(forecast->frames, 3u);
  EXPECT_EQ(forecast->samples, 3u * 40 * 30 * 1000);
  EXPECT_TRUE(forecast->is_adaptive);
}

TEST(Forecast, FailsAsRenderingWould) {
  SceneOptions options = Box();
  options.path = "missing.pbrt";
  Cancellation cancellation;
  EXPECT_EQ(MakeForecast(options, 1, std::chrono::milliseconds(1), cancellation).error().kind,
            ErrorKind::kBadInput);
  cancellation.Cancel({ErrorKind::kInterrupted, "interrupted"});
  EXPECT_EQ(MakeForecast(Box(), 1, std::chrono::milliseconds(1), cancellation).error().kind,
            ErrorKind::kInterrupted);
}

TEST(Forecast, IsTextForPeopleAndJsonForPrograms) {
  const Forecast forecast{2, 640, 360, 64, true, 29'491'200, 3, 2'500'000, 8, 1.5, 1e6, 300'000'000, {}};
  const std::string text = ForecastText(forecast);
  EXPECT_THAT(text, HasSubstr("2 of 640 x 360 pixels, at most 64 samples per pixel"));
  EXPECT_THAT(text, HasSubstr("3, 2.50 MB"));
  EXPECT_THAT(text, HasSubstr("at most about 31.0 s on this machine with 8 threads (1000000 samples/s)"));
  EXPECT_THAT(ForecastJson(forecast), HasSubstr("\"samples\":29491200"));
}

}  // namespace
}  // namespace tessera
