// Pictures as files: FOLDER/JOB/FRAME.exr.
#pragma once

#include <string>

#include "coordinator/store/picture_store.h"

namespace tessera {

class FilePictures final : public PictureStore {
 public:
  // `folder` must exist.
  explicit FilePictures(std::string folder) : folder_(std::move(folder)) {}
  Result<void> Write(JobId job, uint32_t frame, std::string_view bytes) override;
  Result<std::string> Read(JobId job, uint32_t frame, const PictureFile& file) const override;
  Result<std::string> ReadPartial(JobId job, uint32_t frame) const override;
  Result<StoredPicture> Open(JobId job, uint32_t frame,
                             const std::optional<PictureFile>& file) const override;
  Result<void> Probe(JobId job, uint32_t frame, const PictureFile& file) const override;
  void Remove(JobId job) override;

 private:
  std::string FolderOf(JobId job) const;
  std::string PathOf(JobId job, uint32_t frame) const;

  const std::string folder_;
};

}  // namespace tessera
