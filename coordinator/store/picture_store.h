// Where the pictures of finished frames are kept.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

// Thread safe.
class PictureStore {
 public:
  virtual ~PictureStore() = default;
  // Replaces the picture of a frame by `bytes`, an EXR file. The picture is on stable storage when this
  // succeeds; when it fails, a former picture is still there.
  virtual Result<void> Write(JobId job, uint32_t frame, std::string_view bytes) = 0;
  // The bytes last written; an error if there are none or they cannot be read.
  virtual Result<std::string> Read(JobId job, uint32_t frame) const = 0;
  // Removes all pictures of a job as far as that is possible.
  virtual void Remove(JobId job) = 0;
};

}  // namespace tessera
