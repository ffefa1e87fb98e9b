#include "client/saved_picture.h"

#include <nlohmann/json.hpp>

#include "client/png_file.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/file.h"

namespace tessera {

Result<SavedPicture> SavePicture(std::string_view exr, int frame, const PictureNames& names) {
  const std::string path = names.Exr(frame), png = names.Png(frame);
  if (auto written = WriteFileAtomically(path, exr); !written) return written.error();
  if (!png.empty()) {
    const auto picture = DecodeExr(exr, path);
    if (!picture) return picture.error();
    const auto encoded = EncodePng(*picture, png);
    if (!encoded) return encoded.error();
    if (auto written = WriteFileAtomically(png, *encoded); !written) return written.error();
  }
  return SavedPicture{frame, path, Sha256(exr)};
}

std::string PicturesJson(const std::vector<SavedPicture>& pictures, bool is_sequence, double seconds) {
  nlohmann::ordered_json json;
  if (is_sequence) {
    json["frames"] = nlohmann::ordered_json::array();
    for (const SavedPicture& picture : pictures) {
      json["frames"].push_back(
          {{"frame", picture.frame}, {"output", picture.path}, {"sha256", picture.digest.Hex()}});
    }
  } else if (!pictures.empty()) {
    json["output"] = pictures.front().path;
    json["sha256"] = pictures.front().digest.Hex();
  }
  json["seconds"] = seconds;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace tessera
