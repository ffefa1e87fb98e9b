// What is left to do of one frame: which samples of which tiles are done, held by someone, or open, and what
// they cost. Pure bookkeeping: who holds what is the lease table's. Owned by the scheduler.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "coordinator/core/sample_set.h"
#include "renderer/film/adaptive.h"
#include "renderer/film/frame_spec.h"

namespace tessera {

// Samples of a tile.
struct TileSamples {
  uint32_t tile = 0;
  SampleRange range;
  auto operator<=>(const TileSamples&) const = default;
};

// Of an adaptive frame only those samples are open that its tiles want by now, and they are those of some
// pixels only; a tile that stops has no others. A cost in seconds is what a worker of speed 1 takes on one
// slot.
class FrameWork {
 public:
  // The first `samples_done` samples of every tile are done already.
  explicit FrameWork(const FrameSpec& spec, uint32_t samples_done = 0);
  // Every tile gets more samples. Not of an adaptive frame.
  void Extend(uint32_t samples_per_pixel);

  // Takes open samples, those first that complete the image at the fewest samples per pixel (a doubling), and
  // as many as cost at most `cost_max` seconds; one sample if nothing is measured yet. Only of tiles that
  // `may` allows.
  std::optional<TileSamples> Take(double cost_max, const std::function<bool(uint32_t tile)>& may);
  // Opens those of the samples again that are neither done nor in `held` (ranges of the same tile).
  void GiveBack(TileSamples samples, std::span<const SampleRange> held);
  // Takes exactly these, if all are open.
  bool TakeExactly(TileSamples samples);
  // Marks as done; false if all were done before.
  bool Finish(TileSamples samples);
  // Also of samples that the tile stopped before.
  bool IsDone(TileSamples samples) const;
  bool HasDone(TileSamples samples) const;  // any of them
  // What the tile wants by now: never less than it was told before. True if samples opened.
  bool SetGoal(uint32_t tile, const TileGoal& goal);
  // The pixels of the tile whose samples are open or held.
  const PixelMask& Pixels(uint32_t tile) const { return tiles_[tile].pixels; }
  uint32_t PixelCount(uint32_t tile) const { return tiles_[tile].pixel_count; }

  // A measurement.
  void RecordCost(TileSamples samples, double cost);
  // Expected; nothing if nothing of the frame has been measured.
  std::optional<double> Cost(TileSamples samples) const;
  // Whether the tile itself was measured, not just others of its frame.
  bool IsMeasured(uint32_t tile) const { return tiles_[tile].measured_samples > 0; }
  // Of all open samples; nothing if nothing of the frame has been measured.
  std::optional<double> OpenCost() const;

  bool HasOpen() const { return !order_.empty(); }
  bool HasOpen(const std::function<bool(uint32_t tile)>& may) const;
  bool Complete() const { return samples_left_ == 0; }

 private:
  struct Tile {
    uint32_t area = 0;         // pixels
    uint32_t pixel_count = 0;  // of `pixels`
    PixelMask pixels;
    SampleSet open, done;
    uint32_t wanted = 0;  // samples [0, wanted) have been opened
    bool stopped = false;
    double measured_samples = 0;  // pixel samples
    double measured_cost = 0;
  };
  // Tiles with open samples by the doubling that the first of them belongs to.
  using Order = std::set<std::pair<int, uint32_t>>;

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
