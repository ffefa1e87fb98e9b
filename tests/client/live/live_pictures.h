// Pictures for tests of views.
#pragma once

#include "client/live/picture_view.h"

namespace tessera {

// All pixels have values that follow from their place, their channel and `seed`.
inline LoadedPicture PictureOf(int width, int height, float seed,
                               std::vector<std::string> channels = {"R", "G", "B"}) {
  LoadedPicture picture;
  picture.width = width;
  picture.height = height;
  picture.bounds = {0, 0, width, height};
  picture.channels = std::move(channels);
  const size_t count = static_cast<size_t>(width) * static_cast<size_t>(height) * picture.channels.size();
  for (size_t i = 0; i < count; ++i) picture.values.push_back(seed + static_cast<float>(i % 997) / 1000);
  return picture;
}

}  // namespace tessera
