// What of a frame is still wanted, cut into units: for renders in one process, where nobody but the threads
// of this process takes work. A farm's scheduler has more to decide.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "renderer/film/merger.h"

namespace tessera {

// Not thread safe.
class UnitQueue {
 public:
  struct Unit {
    int tile = 0;
    SampleRange range;
    PixelMask pixels;  // of the tile: those whose samples are wanted
  };

  using ChooseTile = std::function<bool(const PixelBounds& tile)>;
  // A unit has at most `samples_max` pixel samples, or one sample of each pixel of a tile. Tiles for which
  // `goes_first`, if given, is true go before all others.
  UnitQueue(FrameSpec spec, int64_t samples_max, const ChooseTile& goes_first = {});

  // Takes the next unit. Returns nullopt if everything that is wanted by now is taken; of an adaptive frame
  // the results of units that are taken may make more samples wanted.
  std::optional<Unit> Take();
  // Whether Take would return a unit.
  bool HasUnit() const { return !open_.empty() || started_ < tiles_.size(); }
  // Merges the result of a unit that was taken.
  void Merge(const Unit& unit, RadianceTile sums);
  // Units that are taken and not merged.
  int taken() const { return taken_; }
  const Merger& merger() const { return merger_; }

 private:
  // Samples [begin, end) of a tile are wanted and not taken.
  struct Open {
    int tile;
    uint32_t begin, end;
  };

  Merger merger_;
  uint32_t range_size_max_;
  std::vector<Open> open_;  // a stack: a tile is finished before another is started
  std::vector<int> tiles_;  // all, in the order in which they are started
  size_t started_ = 0;      // of them
  int taken_ = 0;
};

}  // namespace tessera
