// A picture in 8-bit sRGB colours, tone-mapped as the client's PNG files are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "renderer/film/display_color.h"
#include "renderer/film/frame_snapshot.h"
#include "renderer/film/picture_file.h"

namespace tessera {

// The step with which a frame's picture has at most `size` pixels in each direction.
int StepFor(const FrameSpec& spec, int size);

class ColorPicture {
 public:
  // Every step-th pixel of the crop in each direction; black at first.
  ColorPicture(const FrameSpec& spec, int step);
  // A tile, see FrameSnapshot::TilePicture.
  void Paint(const FramePicture& tile);
  // Every step-th pixel of a picture of the whole crop.
  void Paint(const LoadedPicture& picture, int step);
  std::string Png() const;

 private:
  void Set(int x, int y, const LinearRgb& linear);
  int width_, height_;
  std::vector<uint8_t> rgb_;
};

}  // namespace tessera
