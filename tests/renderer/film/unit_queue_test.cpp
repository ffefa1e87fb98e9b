#include "renderer/film/unit_queue.h"

#include <gtest/gtest.h>

#include <deque>

#include "tests/renderer/film/adaptive_frames.h"

namespace tessera {
namespace {

// Renders a frame with `in_flight_max` units taken at a time. The latest is finished first if `latest_first`.
FramePicture RenderFrame(const FrameSpec& spec, int64_t samples_max, size_t in_flight_max, bool latest_first,
                         const UnitQueue::ChooseTile& goes_first = {}) {
  UnitQueue queue(spec, samples_max, goes_first);
  std::deque<UnitQueue::Unit> in_flight;
  while (true) {
    while (in_flight.size() < in_flight_max) {
      const bool has_unit = queue.HasUnit();
      auto unit = queue.Take();
      EXPECT_EQ(unit.has_value(), has_unit);
      if (!unit) break;
      in_flight.push_back(*unit);
    }
    EXPECT_EQ(static_cast<size_t>(queue.taken()), in_flight.size());
    if (in_flight.empty()) break;
    const UnitQueue::Unit unit = latest_first ? in_flight.back() : in_flight.front();
    latest_first ? in_flight.pop_back() : in_flight.pop_front();
    EXPECT_FALSE(queue.merger().Has(unit.tile, unit.range)) << "taken twice";
    queue.Merge(unit, RenderNoise(spec, unit.tile, unit.range, unit.pixels));
  }
  EXPECT_TRUE(queue.merger().Complete());
  return queue.merger().Picture();
}

TEST(UnitQueue, GivesTheSamePictureHoweverUnitsAreCutAndFinished) {
  for (const double threshold : {0.0, 0.3}) {
    const FrameSpec spec = AdaptiveSpec(200, threshold);
    const FramePicture reference = RenderFrame(spec, 1, 1, false);
    for (const int64_t samples_max : {int64_t{100}, int64_t{5000}, int64_t{1} << 40}) {
      for (const bool latest_first : {false, true}) {
        const FramePicture picture = RenderFrame(spec, samples_max, 5, latest_first);
        EXPECT_EQ(picture.values, reference.values) << threshold << ' ' << samples_max;
      }
    }
  }
}

TEST(UnitQueue, RendersARegionFirstWithoutChangingThePicture) {
  for (const double threshold : {0.0, 0.3}) {
    const FrameSpec spec = AdaptiveSpec(200, threshold);
    const auto last = [corner = spec.TileBounds(spec.TileCount() - 1)](const PixelBounds& tile) {
      return tile == corner;
    };
    UnitQueue queue(spec, 1, last);
    EXPECT_EQ(queue.Take()->tile, spec.TileCount() - 1);
    EXPECT_EQ(RenderFrame(spec, 5000, 5, false, last).values, RenderFrame(spec, 1, 1, false).values);
  }
}

TEST(UnitQueue, KeepsUnitsBelowTheirLimit) {
  FrameSpec spec = AdaptiveSpec(1024, 0);
  UnitQueue queue(spec, 640);
  int64_t largest = 0;
  while (const auto unit = queue.Take()) {
    largest = std::max(largest, spec.TileBounds(unit->tile).area() * int64_t{unit->range.size});
    queue.Merge(*unit, RenderNoise(spec, unit->tile, unit->range, unit->pixels));
  }
  EXPECT_EQ(largest, 8 * 64) << "the largest power of two of samples of a tile of 64 pixels";
}

}  // namespace
}  // namespace tessera
