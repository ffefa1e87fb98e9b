// The layers of a picture, each as a picture of its own (--aov-split).
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "renderer/film/picture_file.h"

namespace tessera {

// The layer of a channel: "albedo" of "albedo.R", "depth" of "depth"; "" of the colours and alpha. `mattes`
// are the layers of Cryptomatte, of which each has several groups of ranks.
std::string LayerOf(const std::string& channel, const std::vector<std::string>& mattes);

// The layer as a part of a file's name: letters, digits, "-" and "_".
std::string FileLayer(const std::string& layer);

// Those of the picture of a frame, but for the colours.
std::set<std::string> FileLayersOf(const FrameSpec& frame);

struct LayerPicture {
  std::string layer;  // "": the colours and alpha
  LoadedPicture picture;
};
// The colours first, then the others by name. Each has the header of the whole, but only the names of its own
// mattes. Layers that have the same FileLayer are an error.
Result<std::vector<LayerPicture>> SplitLayers(const LoadedPicture& picture);

// How an .exr file is written that is not to be as the farm wrote it.
struct ExrOutput {
  bool splits_layers = false;                 // each layer to a file of its own
  std::optional<ExrCompression> compression;  // empty: that of the farm's file
  std::optional<ExrLayout> layout;            // the same
  bool has_preview = false;

  bool IsAsFetched() const { return !splits_layers && !compression && !layout && !has_preview; }
};

// Fails if the compression would change a channel of a whole file that must stay exact: one that is stored as
// float, and is not one of the colours or alpha.
Result<void> CheckCompression(const FrameSpec& frame, const ExrOutput& output);
Result<void> CheckCompression(const LoadedPicture& picture, const ExrOutput& output);

// The format of a whole file, or of that of a layer. A layer that the compression would change although it
// must stay exact has zip.
ExrFormat FormatOf(const LoadedPicture& picture, const ExrOutput& output);
ExrFormat FormatOf(const LayerPicture& layer, const ExrOutput& output);

}  // namespace tessera
