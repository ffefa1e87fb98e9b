// Finished pictures in files.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "client/picture_names.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

struct SavedPicture {
  int frame = 0;
  std::string path;
  Digest digest;  // of the file's bytes
};

// What becomes of a picture that cannot be written.
enum class IfUnsaved {
  kFail,    // it can be fetched again
  kRescue,  // it exists nowhere else: its OpenEXR file is kept in a folder of $TMPDIR, which the error names
};

// Writes the bytes of an OpenEXR file, or what they hold in the format that the picture's name asks for, and
// a PNG if `names` asks for one. Whether the picture was rendered here or fetched from a farm, all files are
// made of the same bytes. `stop` as in WriteOutput.
Result<SavedPicture> SavePicture(std::string_view exr, int frame, const PictureNames& names,
                                 std::stop_token stop, IfUnsaved if_unsaved = IfUnsaved::kFail);

// {"output": ..., "sha256": ..., "seconds": ...}, or for a sequence {"frames": [{"frame": ..., "output": ...,
// ...}], ...}.
std::string PicturesJson(const std::vector<SavedPicture>& pictures, bool is_sequence, double seconds);

}  // namespace tessera
