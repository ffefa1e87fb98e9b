#include "client/output/picture_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace tessera {
namespace {

constexpr int kJpegSideMax = 65500;  // pixels: JPEG_MAX_DIMENSION of libjpeg

struct Ending {
  const char* ending;
  PictureFormat format;
};
constexpr Ending kEndings[] = {
    {"exr", PictureFormat::kExr},      {"png", PictureFormat::kPng},  {"jpg", PictureFormat::kJpeg},
    {"jpeg", PictureFormat::kJpeg},    {"tif", PictureFormat::kTiff}, {"tiff", PictureFormat::kTiff},
    {"hdr", PictureFormat::kRadiance}, {"pfm", PictureFormat::kPfm},
};

}  // namespace

Result<PictureFormat> PictureFormatOf(const std::string& path) {
  const std::string name = path.substr(path.rfind('/') + 1);
  const size_t dot = name.rfind('.');
  if (dot == std::string::npos) return PictureFormat::kExr;
  std::string ending = name.substr(dot + 1);
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto* const found = std::ranges::find(kEndings, ending, &Ending::ending);
  if (found != std::end(kEndings)) return found->format;
  return BadInput(
      fmt::format("{}: cannot write pictures of type .{}; use .exr, .png, .jpg, .tif, .hdr or .pfm", path,
                  name.substr(dot + 1)));
}

Result<void> CheckFormatSize(const std::string& path, int width, int height) {
  const auto format = PictureFormatOf(path);
  if (!format) return format.error();
  if (*format != PictureFormat::kJpeg || (width <= kJpegSideMax && height <= kJpegSideMax)) return {};
  return BadInput(fmt::format("{}: a JPEG has at most {} pixels per side, the picture has {}x{}", path,
                              kJpegSideMax, width, height));
}

}  // namespace tessera
