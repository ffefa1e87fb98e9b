// What of one frame is done, wanted and open, and what it costs. This is the only place that is asked: a
// merger adds up sums and decides the goals of adaptive tiles, which flow in here with SetGoal. Pure
// bookkeeping: who holds what is in the lease table. Owned by the scheduler.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "coordinator/core/schedule/sample_set.h"
#include "renderer/film/adaptive.h"
#include "renderer/film/frame_spec.h"

namespace tessera {

// Samples of a tile.
struct TileSamples {
  uint32_t tile = 0;
  SampleRange range;
  auto operator<=>(const TileSamples&) const = default;
};

// Of an adaptive frame only those samples are open that the present goals of its tiles ask for, of some
// pixels only. Costs are in seconds that a worker of speed 1 takes on one slot.
class FrameWork {
 public:
  // The first `samples_done` samples of every tile are done already. Tiles that `first` overlaps go before
  // all others.
  explicit FrameWork(const FrameSpec& spec, uint32_t samples_done = 0, const PixelBounds& first = {});
  // Every tile gets more samples. The frame must not be adaptive.
  void Extend(uint32_t samples_per_pixel);

  // Takes open samples of a tile that `may` allows. Tiles of the region that is rendered first precede all
  // others; within each group, samples that complete the image at the fewest samples per pixel (a
  // doubling) come first. Takes as many as cost at most `cost_max` seconds, or one sample if nothing is
  // measured yet. Returns nullopt if there are none.
  std::optional<TileSamples> Take(double cost_max, const std::function<bool(uint32_t tile)>& may);
  // Opens the samples again, except those that are done or in `held` (ranges of the same tile).
  void GiveBack(TileSamples samples, std::span<const SampleRange> held);
  // Takes exactly these samples; false, and nothing changes, unless all of them are open.
  bool TakeExactly(TileSamples samples);
  // Marks samples as done; false if all were done before.
  bool Finish(TileSamples samples);
  // Whether all of the samples are done; those beyond the end of a tile that stopped count as done.
  bool IsDone(TileSamples samples) const;
  // Whether some of them are.
  bool HasDone(TileSamples samples) const;
  // Sets what is wanted of the tile; never fewer samples than before. True if samples opened.
  bool SetGoal(uint32_t tile, const TileGoal& goal);
  const TileGoal& Goal(uint32_t tile) const { return tiles_[tile].goal; }
  // The pixels of the tile whose samples are open or held.
  const PixelMask& Pixels(uint32_t tile) const { return tiles_[tile].goal.pixels; }
  uint32_t PixelCount(uint32_t tile) const { return tiles_[tile].pixel_count; }

  // Samples of the tile took this long.
  void RecordCost(TileSamples samples, double cost);
  // Expected cost; nullopt if nothing of the frame has been measured.
  std::optional<double> Cost(TileSamples samples) const;
  // Whether the tile itself was measured, not just others of its frame.
  bool IsMeasured(uint32_t tile) const { return tiles_[tile].measured_samples > 0; }
  // Of all open samples; nullopt if nothing of the frame has been measured.
  std::optional<double> OpenCost() const;

  bool HasOpen() const { return !order_.empty(); }
  bool HasOpen(const std::function<bool(uint32_t tile)>& may) const;
  bool Complete() const { return samples_left_ == 0; }

 private:
  struct Tile {
    uint32_t area = 0;         // pixels
    uint32_t pixel_count = 0;  // of the goal
    TileGoal goal;             // samples [0, goal.samples) have been opened
    SampleSet open, done;
    bool has_stopped = false;
    bool goes_first = false;
    double measured_samples = 0;  // pixel samples
    double measured_cost = 0;
  };
  // Tiles with open samples: those of the region that is rendered first, then the others, each ordered by the
  // doubling that their first open sample belongs to.
  struct Place {
    bool goes_later;
    int level;
    uint32_t tile;
    auto operator<=>(const Place&) const = default;
  };
  using Order = std::set<Place>;

  double CostPerPixelSample(const Tile& tile) const;
  void Stop(Tile& tile);
  uint32_t PieceSize(const Tile& tile, double cost_max) const;
  // Changes the tile's open samples and all that follows from them.
  template <typename Change>
  void ChangeOpen(uint32_t tile, Change change);

  uint32_t samples_per_pixel_;
  uint32_t first_unit_max_;  // samples of a unit that begins with sample 0
  std::vector<Tile> tiles_;
  Order order_;
  uint64_t samples_left_ = 0;                        // of each pixel, over all tiles: not done
  double measured_samples_ = 0, measured_cost_ = 0;  // of the whole frame
  double open_measured_cost_ = 0;                    // of open samples of measured tiles
  double open_unmeasured_samples_ = 0;               // pixel samples
};

}  // namespace tessera
