// Where the pictures of finished frames are kept.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "coordinator/core/schedule/picture_file.h"
#include "proto/terms.h"
#include "renderer/util/digest.h"
#include "renderer/util/readable_file.h"
#include "renderer/util/result.h"

namespace tessera {

// A picture to be sent in pieces: none is in memory as a whole.
struct StoredPicture {
  ReadableFile file;
  Digest digest;  // of its bytes, all of which were read once
};

// Thread safe. Errors of what reads a picture are kInterrupted if the system lacks descriptors or memory: the
// picture may be intact.
class PictureStore {
 public:
  virtual ~PictureStore() = default;
  // Replaces the picture of a frame by `bytes`, an EXR file. The picture is on stable storage when this
  // succeeds; when it fails, a former picture is still there.
  virtual Result<void> Write(JobId job, uint32_t frame, std::string_view bytes) = 0;
  // The picture of a frame, which was written as `file`. An error that names the file if it is not there, if
  // it cannot be read, or if its bytes are others than those written.
  virtual Result<std::string> Read(JobId job, uint32_t frame, const PictureFile& file) const = 0;
  // The picture that was written last of a frame whose job ended before it was finished: what it was written
  // as is not recorded.
  virtual Result<std::string> ReadPartial(JobId job, uint32_t frame) const = 0;
  // The same pictures to be sent: the one that was written as `file`, or without it the one that was written
  // last. Slow: reads all bytes.
  virtual Result<StoredPicture> Open(JobId job, uint32_t frame,
                                     const std::optional<PictureFile>& file) const = 0;
  // As much of Read as costs little: whether the picture is there and has its size.
  virtual Result<void> Probe(JobId job, uint32_t frame, const PictureFile& file) const = 0;
  // Removes all pictures of a job as far as that is possible.
  virtual void Remove(JobId job) = 0;
};

}  // namespace tessera
