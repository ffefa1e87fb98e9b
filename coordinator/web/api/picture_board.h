// The picture of one frame as its streams send it: regions of fixed size, each encoded once for all readers.
// Written by one thread, read by others.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/web/api/layer_painter.h"
#include "coordinator/web/api/picture_format.h"
#include "coordinator/web/http_response.h"
#include "renderer/film/frame_snapshot.h"
#include "renderer/film/picture_file.h"

namespace tessera {

// 1920 x 1080 pixels in colour: some 25 MB of floats for each layer of a frame that is watched.
constexpr int64_t kLiveValuesMax = 3 * (int64_t{1} << 21);
constexpr int kRegionSize = 64;  // pixels: a changed tile costs 25 KB of halves

class PictureBoard {
 public:
  // What a reader has received.
  struct Cursor {
    uint64_t picture = 0;  // 0: nothing
    uint64_t state = 0;
    uint64_t problem = 0;
    std::vector<uint64_t> regions;
    size_t next = 0;
  };

  // `layer`: its name (picture_layers.h). A frame without it shows its colours.
  explicit PictureBoard(std::string layer = "") : layer_(std::move(layer)) {}

  // ---- Of the writer ----
  // Shows what differs from the last snapshot.
  void Show(const FrameSnapshot& snapshot);
  // Shows a picture that was read from its file.
  void Show(const FrameSpec& spec, const LoadedPicture& picture);
  void SetState(uint64_t samples_done, uint64_t samples_total, bool is_finished);
  // Why the picture cannot be shown, or is older than it could be; empty: it can.
  void SetProblem(std::string_view reason);
  void End();

  // ---- Thread safe ----
  // Adds what the reader has not received, up to some `bytes_max`. Returns the number of bytes.
  size_t Collect(size_t bytes_max, Cursor& cursor, std::vector<BodyStream::Part>& parts) const;
  bool HasEnded() const;
  // Of all regions.
  size_t bytes() const;

 private:
  struct Region {
    PixelBounds bounds;
    BodyStream::Part message;  // null: black
    uint64_t version = 0;
  };
  class Painting;
  LayerPainter PainterOf(const FrameSpec& spec) const;
  void Begin(const PictureShape& shape);
  void Paint(const FramePicture& picture, Painting& painting) const;

  const std::string layer_;
  FrameSnapshot shown_;  // of the writer
  PictureShape shape_;   // changed by the writer alone, with the mutex held
  mutable std::mutex mutex_;
  // Guarded by mutex_.
  std::vector<Region> regions_;
  int columns_ = 0;
  BodyStream::Part frame_, state_, problem_;
  uint64_t pictures_ = 0, states_ = 0, problems_ = 0, version_ = 0;
  bool has_ended_ = false;
};

}  // namespace tessera
