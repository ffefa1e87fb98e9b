// What the web interface reads of pictures. Functions may wait for the core thread or the disk.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "coordinator/core/schedule/picture_file.h"
#include "coordinator/core_thread.h"
#include "coordinator/store/picture_store.h"
#include "coordinator/web/api/web_farm.h"

namespace tessera {

// Both arguments must outlive it and its copies. Thread safe.
class WebPictures {
 public:
  WebPictures(CoreThread& core, const PictureStore& pictures) : core_(core), pictures_(pictures) {}

  WebResult<FrameState> Frame(JobId job, uint32_t frame) const;
  // The EXR file of a frame; without `file`, what was written of one whose job ended early.
  WebResult<std::string> Read(JobId job, uint32_t frame, const std::optional<PictureFile>& file) const;
  WebResult<ReadableFile> Open(JobId job, uint32_t frame, const std::optional<PictureFile>& file) const;

 private:
  // Returns what `read`, of the picture of a frame, gives, or why there is none. Tells the core whether a
  // picture that `is_finished` is intact.
  template <typename Picture>
  WebResult<Picture> Checked(FrameId id, bool is_finished,
                             const std::function<Result<Picture>()>& read) const;

  CoreThread& core_;
  const PictureStore& pictures_;
};

}  // namespace tessera
