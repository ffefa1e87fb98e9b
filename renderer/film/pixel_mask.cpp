#include "renderer/film/pixel_mask.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace tessera {

PixelMask PixelMask::Of(const std::vector<bool>& chosen) {
  PixelMask mask;
  if (std::ranges::all_of(chosen, [](bool each) { return each; })) return mask;
  mask.bits_.assign((chosen.size() + 7) / 8, '\0');
  for (size_t i = 0; i < chosen.size(); ++i) {
    if (chosen[i]) mask.bits_[i / 8] = static_cast<char>(mask.bits_[i / 8] | 1 << i % 8);
  }
  return mask;
}

Result<PixelMask> PixelMask::Read(std::string_view bytes, size_t pixels) {
  PixelMask mask;
  if (bytes.empty()) return mask;
  if (bytes.size() != (pixels + 7) / 8)
    return Failed(fmt::format("a mask of {} pixels has {} bytes", pixels, bytes.size()));
  if (pixels % 8 != 0 && static_cast<unsigned char>(bytes.back()) >> pixels % 8 != 0)
    return Failed("a mask has pixels beyond the last");
  mask.bits_ = bytes;
  const size_t count = mask.Count(pixels);
  if (count == 0) return Failed("a mask has no pixels");
  if (count == pixels) mask.bits_.clear();
  return mask;
}

size_t PixelMask::Count(size_t pixels) const {
  if (HasAll()) return pixels;
  size_t count = 0;
  for (const char byte : bits_) count += static_cast<size_t>(std::popcount(static_cast<unsigned char>(byte)));
  return count;
}

}  // namespace tessera
