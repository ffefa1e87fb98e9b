// What is merged of a frame at one moment, as a value. Taking one costs a few pointers per tile, so the
// thread that owns the merger can hand it to another thread, which paints and encodes the picture.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "renderer/film/frame_spec.h"
#include "renderer/film/sample_range.h"
#include "renderer/film/shared_sums.h"

namespace tessera {

// A finished or partly finished picture: the channels that the frame writes, by PictureChannels.
struct FramePicture {
  PixelBounds bounds;                 // data window
  std::vector<std::string> channels;  // their names
  std::vector<float> values;          // [(y * width + x) * channels + c]
  uint32_t samples_min = 0;           // of the pixel that has the fewest

  // The values of one channel, pixel by pixel; empty if the picture does not have it.
  std::vector<float> Channel(const std::string& name) const;
};

class TilePainter;

// Immutable once built; may be read on any thread.
class FrameSnapshot {
 public:
  // Disjoint nodes of one tile in order of their samples.
  using TileNodes = std::vector<std::pair<SampleRange, SharedSums>>;

  FrameSnapshot() = default;
  // `tiles` has an entry for every tile of the frame, or none if nothing of it is merged.
  FrameSnapshot(FrameSpec spec, std::vector<TileNodes> tiles)
      : spec_(std::move(spec)), tiles_(std::move(tiles)) {}

  // A tile with a complete prefix [0, n) shows that, any other what it has; black where it has nothing.
  FramePicture Picture() const { return PictureOf(spec_, 1); }

  // A picture of at most `values_max` values that has every n-th pixel of each row and column, and the frame
  // that it is a picture of. n is 1 if the whole picture has no more values.
  struct Preview {
    FrameSpec spec;
    FramePicture picture;
  };
  Preview MakePreview(int64_t values_max) const;

  const FrameSpec& spec() const { return spec_; }
  const TileNodes& NodesOf(int tile) const;
  // Whether a tile shows the same as in another snapshot of the frame. May be false if it does.
  bool IsSameTile(int tile, const FrameSnapshot& other) const;
  // What Picture shows of one tile, at the pixels of the crop whose row and column are multiples of `step`.
  // The bounds are in such pixels, counted from the corner of the crop; they may be empty.
  FramePicture TilePicture(int tile, int step) const;

 private:
  FramePicture PictureOf(const FrameSpec& spec, int step) const;
  // `window`: the pixels that the picture has, see TilePicture.
  void Paint(int tile, const TilePainter& painter, int step, const PixelBounds& window,
             FramePicture& picture) const;

  FrameSpec spec_;
  std::vector<TileNodes> tiles_;
};

}  // namespace tessera
