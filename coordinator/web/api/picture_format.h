// The stream of a picture that refines, as /api/v1/jobs/{job}/picture sends it: a sequence of messages. All
// numbers are little-endian.
//
//   offset  bytes  of each message
//        0      4  "TPIX"
//        4      1  version of the format, 1
//        5      1  kind: 1 frame, 2 region, 3 state, 4 problem
//        6      2  0
//        8      4  size of the payload that follows
//
// A *frame* comes first, and again when the picture has another size or another number of samples; all pixels
// are black then. Its payload: width and height of the picture in pixels of this stream (4 + 4 bytes), step
// (4): every step-th pixel of the frame in each direction is shown, x and y of the first shown pixel in the
// frame (4 + 4), width and height of the frame (4 + 4), type of the values (1): 1 half, 2 float, those that
// the OpenEXR file has or will have, channels (1), and 2 bytes that are 0. The channels are those of the
// layer that the stream shows (picture_layers.h): 3 for colours and vectors, 3 for each of several light
// groups, 1 for most others.
//
// A *region* replaces the pixels of a rectangle: x0, y0, width, height (4 x 4 bytes, in pixels of this
// stream), then the values row by row, channels of a pixel next to each other.
//
// A *state* ends an update: samples done and samples of the whole frame or job (8 + 8), then 1 if the picture
// is finished, otherwise 0 (1), and 7 bytes that are 0. A reader that is slow gets fewer updates and never
// more than one update late.
//
// A *problem* is the reason why the picture cannot be shown, or shown as it is by now, in UTF-8; without a
// payload, there is none any more. It may come before the first frame.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/web/api/picture_layers.h"
#include "renderer/film/frame_spec.h"

namespace tessera {

constexpr uint8_t kPictureFormatVersion = 1;
constexpr size_t kProblemBytesMax = 1000;
// The positions of red, green and blue among the channels of a picture. One without them is shown by its
// first channel.
using ColorPlaces = std::array<size_t, 3>;
ColorPlaces FindColors(const std::vector<std::string>& channels);

// What a stream shows of a frame.
struct PictureShape {
  int width = 0, height = 0;  // in shown pixels
  int step = 1;
  PixelBounds crop;  // of the frame
  int frame_width = 0, frame_height = 0;
  ExrType type = ExrType::kHalf;
  size_t channels = 3;
  bool operator==(const PictureShape&) const = default;
  size_t ValueBytes() const { return type == ExrType::kHalf ? 2 : 4; }
};

// The shape in which a layer has at most `values_max` values.
PictureShape ShapeOf(const FrameSpec& spec, const PictureLayer& layer, int64_t values_max);

std::string FrameMessage(const PictureShape& shape);
// A region whose pixels are black.
std::string RegionMessage(const PictureShape& shape, const PixelBounds& bounds);
// Sets a pixel of a region, whose bounds are `bounds`, to the values that the file has for these.
void SetPixel(const PictureShape& shape, const PixelBounds& bounds, int x, int y,
              std::span<const float> values, std::string& region);
// Of at most kProblemBytesMax bytes.
std::string ProblemMessage(std::string_view reason);
std::string StateMessage(uint64_t samples_done, uint64_t samples_total, bool is_finished);

}  // namespace tessera
