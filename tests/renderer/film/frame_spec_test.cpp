#include "renderer/film/frame_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace tessera {
namespace {

FrameSpec ValidSpec() {
  FrameSpec spec;
  spec.width = 100;
  spec.height = 60;
  spec.crop = {10, 5, 77, 60};
  spec.samples_per_pixel = 12;
  spec.tile_size = 16;
  return spec;
}

TEST(FrameSpec, TilesCoverEveryPixelOfTheCropOnce) {
  for (int tile_size : {1, 7, 16, 32, 67, 256}) {
    FrameSpec spec = ValidSpec();
    spec.tile_size = tile_size;
    ASSERT_TRUE(spec.Check());
    std::vector<int> covered(static_cast<size_t>(spec.width * spec.height), 0);
    for (int tile = 0; tile < spec.TileCount(); ++tile) {
      const PixelBounds bounds = spec.TileBounds(tile);
      EXPECT_GT(bounds.area(), 0);
      for (int y = bounds.y0; y < bounds.y1; ++y) {
        for (int x = bounds.x0; x < bounds.x1; ++x) ++covered[static_cast<size_t>(y * spec.width + x)];
      }
    }
    for (int y = 0; y < spec.height; ++y) {
      for (int x = 0; x < spec.width; ++x) {
        const bool inside = x >= spec.crop.x0 && x < spec.crop.x1 && y >= spec.crop.y0 && y < spec.crop.y1;
        ASSERT_EQ(covered[static_cast<size_t>(y * spec.width + x)], inside ? 1 : 0) << x << ' ' << y;
      }
    }
  }
}

struct BadSpec {
  const char* name;
  std::function<void(FrameSpec&)> spoil;
  const char* message;
};

TEST(FrameSpec, EveryLimitIsCheckedWithAMessageThatNamesIt) {
  const BadSpec cases[] = {
      {"no width", [](FrameSpec& s) { s.width = 0; }, "resolution"},
      {"negative height", [](FrameSpec& s) { s.height = -5; }, "resolution"},
      {"huge", [](FrameSpec& s) { s.width = kResolutionMax + 1; }, "resolution"},
      {"empty crop", [](FrameSpec& s) { s.crop.x1 = s.crop.x0; }, "crop"},
      {"crop outside", [](FrameSpec& s) { s.crop.y1 = 61; }, "crop"},
      {"negative crop", [](FrameSpec& s) { s.crop.x0 = -1; }, "crop"},
      {"too many pixels",
       [](FrameSpec& s) {
         s.width = s.height = kResolutionMax;
         s.crop = {0, 0, s.width, s.height};
       },
       "pixels, more than"},
      {"no samples", [](FrameSpec& s) { s.samples_per_pixel = 0; }, "samples per pixel"},
      {"too many samples", [](FrameSpec& s) { s.samples_per_pixel = kSamplesPerPixelMax + 1; },
       "samples per pixel"},
      {"no tile size", [](FrameSpec& s) { s.tile_size = 0; }, "tile size"},
      {"large tile size", [](FrameSpec& s) { s.tile_size = kTileSizeMax + 1; }, "tile size"},
      {"too many tiles",
       [](FrameSpec& s) {
         s.width = s.height = 4096;
         s.crop = {0, 0, 4096, 4096};
         s.tile_size = 1;
       },
       "more than the limit"},
      {"no channels", [](FrameSpec& s) { s.channels = ColorsAndWeight({}); }, "channels"},
      {"no weight", [](FrameSpec& s) { s.channels.pop_back(); }, "filter weight"},
      {"double channel",
       [](FrameSpec& s) {
         s.channels = ColorsAndWeight({"R", "R"});
       },
       "twice"},
      {"adaptive frame that does not count its samples", [](FrameSpec& s) { s.noise_threshold = 0.1; },
       "needs the channel \"samples\""},
      {"adaptive frame without colour",
       [](FrameSpec& s) {
         s.channels = ColorsAndWeight({"albedo.R"});
         s.SetNoiseThreshold(0.1);
       },
       "R, G or B"},
      {"unnamed channel", [](FrameSpec& s) { s.channels = ColorsAndWeight({""}); }, "channel"},
      {"unnamed attribute", [](FrameSpec& s) { s.attributes[""] = "x"; }, "attribute"},
      {"reserved attribute", [](FrameSpec& s) { s.attributes["dataWindow"] = "x"; }, "reserved"},
      {"long attribute", [](FrameSpec& s) { s.attributes["a"] = std::string(kAttributeSizeMax, 'x'); },
       "longer"},
  };
  for (const BadSpec& bad : cases) {
    FrameSpec spec = ValidSpec();
    bad.spoil(spec);
    const Result<void> checked = spec.Check();
    ASSERT_FALSE(checked) << bad.name;
    EXPECT_EQ(checked.error().kind, ErrorKind::kBadInput) << bad.name;
    EXPECT_THAT(checked.error().message, testing::HasSubstr(bad.message)) << bad.name;
  }
}

}  // namespace
}  // namespace tessera
