// Paints one layer of a frame, from what is merged of it or from its file.
#pragma once

#include <optional>

#include "coordinator/web/api/picture_layers.h"
#include "renderer/film/frame_snapshot.h"
#include "renderer/film/picture_file.h"

namespace tessera {

class LayerPainter {
 public:
  explicit LayerPainter(PictureLayer layer) : layer_(std::move(layer)) {}
  const PictureLayer& layer() const { return layer_; }

  // The tile as FrameSnapshot::TilePicture has it, with the channels of the layer. Returns nullopt if nothing
  // can be said of it now: what was known before stays true enough.
  std::optional<FramePicture> Tile(const FrameSnapshot& snapshot, int tile, int step) const;
  // Every step-th pixel of a file. Its bounds are in such pixels. Returns nullopt if the file does not have
  // the layer.
  std::optional<FramePicture> File(const FrameSpec& spec, const LoadedPicture& picture, int step) const;

 private:
  PictureLayer layer_;
};

}  // namespace tessera
