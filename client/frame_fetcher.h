// The pictures of a job, from the farm to files here.
#pragma once

#include <string>
#include <vector>

#include "client/coordinator/coordinator_client.h"
#include "client/options.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

// Where the pictures of a job's frames go.
class PictureNames {
 public:
  enum class Numbers {
    kNone,     // names are meant as they are written
    kInPlace,  // a frame's number goes into a name that has a place for it
    kAlways,   // and into any other name before its ending
  };
  // `output` and `png` as the user wrote them; an empty `png` is none.
  PictureNames(const std::string& output, const std::string& png, Numbers numbers);
  std::string Exr(int frame) const { return NameOf(output_, frame); }
  std::string Png(int frame) const { return NameOf(png_, frame); }
  // Whether all of these could be written.
  Result<void> Check(const std::vector<int>& frames) const;
  const std::string& output() const { return output_; }

 private:
  std::string NameOf(const std::string& name, int frame) const;

  std::string output_, png_;
  Numbers numbers_;
};

struct SavedPicture {
  int frame = 0;
  std::string path;
  Digest digest;
};

// Fetches each picture once. Not thread safe.
class FrameFetcher {
 public:
  FrameFetcher(CoordinatorClient& client, JobId job, PictureNames names)
      : client_(client), job_(job), names_(std::move(names)) {}

  // Saves the pictures that are finished and have not been saved.
  Result<void> SaveFinished();
  // Saves a finished frame, by its index in the job. A file that is there already with the right bytes is
  // left as it is, and nothing travels.
  Result<void> Save(size_t index, const FrameStatus& frame);
  // Saves what is there of a frame.
  Result<void> SavePreview(size_t index, int frame);
  const std::vector<SavedPicture>& saved() const { return saved_; }

 private:
  CoordinatorClient& client_;
  JobId job_;
  PictureNames names_;
  std::vector<bool> is_saved_;
  std::vector<SavedPicture> saved_;
};

// {"output": ..., "sha256": ..., "seconds": ...}; of a sequence {"frames": [{"frame": ..., "output": ...,
// ...}], ...}
std::string PicturesJson(const std::vector<SavedPicture>& pictures, bool is_sequence, double seconds);

}  // namespace tessera
