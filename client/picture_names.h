// Where the pictures of a job's frames are written.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "client/output/layer_files.h"
#include "client/output/output_file.h"
#include "proto/frame_name.h"
#include "renderer/util/result.h"

namespace tessera {

class PictureNames {
 public:
  enum class Numbers {
    kNone,     // names are taken as they are written
    kInPlace,  // a frame number goes into a name that has a place for it
    kAlways,   // and into any other name before its extension
  };
  // `picture` and `png` are names as the user wrote them; an empty `png` means none.
  PictureNames(const std::string& picture, const std::string& png, Numbers numbers,
               Existing existing = Existing::kReplace);
  std::string Picture(int frame) const { return NameOf(picture_, frame); }
  // Returns "" if no PNG is wanted.
  std::string Png(int frame) const { return NameOf(png_, frame); }
  // How .exr files are written. By default they are as the farm wrote them.
  void SetExrOutput(const ExrOutput& output) { exr_ = output; }
  const ExrOutput& exr() const { return exr_; }
  // The name of the file of a layer, a FileLayer: "out.albedo.exr" beside "out.exr", "out.albedo.0001.exr"
  // beside "out.0001.exr".
  std::string Layer(int frame, const std::string& layer) const;
  // The name of the picture of all frames, with a place for the number if it has one.
  const std::string& picture() const { return picture_.text(); }
  // Fails if a picture of these frames cannot be written: its ending names no format, the module that
  // encodes the format is not installed, it exists and is to be kept, its folder does not exist or permits no
  // writing, it would overwrite one of the files `inputs`, or two pictures have the same file. Called before
  // any work is done.
  // `layers` are the layers that are written to files of their own.
  Result<void> Check(const std::vector<int>& frames, const std::set<std::string>& inputs = {},
                     const std::set<std::string>& layers = {}) const;
  Existing existing() const { return existing_; }
  // Fails if pictures of this size do not fit the formats.
  Result<void> CheckSize(int width, int height) const;

 private:
  std::string NameOf(const FrameName& name, int frame) const;

  FrameName picture_, png_;
  Numbers numbers_;
  Existing existing_;
  ExrOutput exr_;
};

}  // namespace tessera
