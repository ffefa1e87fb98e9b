#include "renderer/compare/picture_difference.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/check.h"
#include "tests/fuzz/targets.h"

namespace tessera {

bool FuzzPicture(std::string_view bytes) {
  const Result<LoadedPicture> picture = DecodeExr(bytes, "a.exr");
  if (!picture) {
    TESSERA_CHECK(picture.error().message.starts_with("a.exr"));
    TESSERA_CHECK(picture.error().message.find('\n') == std::string::npos);
    return false;
  }
  TESSERA_CHECK(picture->width > 0 && picture->height > 0 && !picture->channels.empty());
  const auto pixels = static_cast<size_t>(picture->bounds.area());
  TESSERA_CHECK(pixels > 0 && picture->values.size() == pixels * picture->channels.size());
  const Result<PictureHeader> header = ReadExrHeader(bytes, "a.exr");
  TESSERA_CHECK(header.has_value() && header->bounds == picture->bounds);
  TESSERA_CHECK(header->channels.size() == picture->channels.size());
  // What was read can be written again, and comes back.
  const Result<std::string> again = EncodeExr(*picture, {});
  TESSERA_CHECK(again.has_value());
  const Result<LoadedPicture> reread = DecodeExr(*again, "b.exr");
  TESSERA_CHECK(reread.has_value() && reread->attributes == picture->attributes);
  const Result<PictureDifference> difference = Compare(*picture, *picture);
  TESSERA_CHECK(difference.has_value() && difference->identical && difference->maxabs == 0);
  return true;
}

}  // namespace tessera
