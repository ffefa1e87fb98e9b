// A picture that is being rendered, where it comes from, and what shows it.
#pragma once

#include <optional>
#include <stop_token>

#include "renderer/film/picture_file.h"
#include "renderer/util/result.h"

namespace tessera {

struct LivePicture {
  int frame = 0;  // FrameRequest::number
  LoadedPicture picture;
};

// Where the picture comes from. Used by one thread.
class PictureSource {
 public:
  virtual ~PictureSource() = default;
  // The picture as it is now. Returns nullopt if nothing is rendered yet, or nothing more since the last
  // call.
  virtual Result<std::optional<LivePicture>> Next(const std::stop_token& stop) = 0;
};

// Something that shows the picture: a file, another program, a terminal. Used by one thread.
class PictureView {
 public:
  virtual ~PictureView() = default;
  // Shows the picture instead of the one before. May take long; ends early if a stop is requested.
  virtual Result<void> Show(const LivePicture& picture, const std::stop_token& stop) = 0;
  // Called several times a second while there is no other picture.
  virtual void Idle() {}
};

}  // namespace tessera
