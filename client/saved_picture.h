// Finished pictures in files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "client/picture_names.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

struct SavedPicture {
  int frame = 0;
  std::string path;  // of the EXR
  Digest digest;     // of its bytes
};

// Writes the bytes of an OpenEXR file and, if `names` asks for one, a PNG of what they hold. Whether the
// picture was rendered here or fetched from a farm, both files are made of the same bytes.
Result<SavedPicture> SavePicture(std::string_view exr, int frame, const PictureNames& names);

// {"output": ..., "sha256": ..., "seconds": ...}, or for a sequence {"frames": [{"frame": ..., "output": ...,
// ...}], ...}.
std::string PicturesJson(const std::vector<SavedPicture>& pictures, bool is_sequence, double seconds);

}  // namespace tessera
