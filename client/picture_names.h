// Where the pictures of a job's frames are written.
#pragma once

#include <string>
#include <vector>

#include "client/frame_name.h"
#include "renderer/util/result.h"

namespace tessera {

class PictureNames {
 public:
  enum class Numbers {
    kNone,     // names are taken as they are written
    kInPlace,  // a frame number goes into a name that has a place for it
    kAlways,   // and into any other name before its extension
  };
  // `exr` and `png` are names as the user wrote them; an empty `png` means none.
  PictureNames(const std::string& exr, const std::string& png, Numbers numbers);
  std::string Exr(int frame) const { return NameOf(exr_, frame); }
  // Returns "" if no PNG is wanted.
  std::string Png(int frame) const { return NameOf(png_, frame); }
  // The EXR name of all frames, with a place for the number if it has one.
  const std::string& exr() const { return exr_.text(); }
  // Fails if the folder of a picture of these frames does not exist or cannot be written to. Called before
  // any work is done.
  Result<void> CheckWritable(const std::vector<int>& frames) const;

 private:
  std::string NameOf(const FrameName& name, int frame) const;

  FrameName exr_, png_;
  Numbers numbers_;
};

}  // namespace tessera
