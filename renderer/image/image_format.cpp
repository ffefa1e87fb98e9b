#include "renderer/image/image_format.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tessera {
namespace {

using namespace std::string_view_literals;

constexpr std::array<std::pair<std::string_view, ImageFormat>, 14> kEndings{{
    {".exr", ImageFormat::kExr},
    {".png", ImageFormat::kPng},
    {".jpg", ImageFormat::kJpeg},
    {".jpeg", ImageFormat::kJpeg},
    {".tga", ImageFormat::kTga},
    {".hdr", ImageFormat::kHdr},
    {".pic", ImageFormat::kHdr},
    {".rgbe", ImageFormat::kHdr},
    {".tif", ImageFormat::kTiff},
    {".tiff", ImageFormat::kTiff},
    {".bmp", ImageFormat::kBmp},
    {".webp", ImageFormat::kWebp},
    {".pfm", ImageFormat::kPfm},
    {".qoi", ImageFormat::kQoi},
}};

constexpr std::array<std::pair<std::string_view, ImageFormat>, 13> kMagic{{
    {"\x76\x2f\x31\x01"sv, ImageFormat::kExr},
    {"\x89PNG\r\n\x1a\n"sv, ImageFormat::kPng},
    {"\xff\xd8\xff"sv, ImageFormat::kJpeg},
    {"#?RADIANCE"sv, ImageFormat::kHdr},
    {"#?RGBE"sv, ImageFormat::kHdr},
    {"II*\0"sv, ImageFormat::kTiff},
    {"MM\0*"sv, ImageFormat::kTiff},
    {"II+\0"sv, ImageFormat::kTiff},
    {"MM\0+"sv, ImageFormat::kTiff},
    {"BM"sv, ImageFormat::kBmp},
    {"PF"sv, ImageFormat::kPfm},
    {"Pf"sv, ImageFormat::kPfm},
    {"qoif"sv, ImageFormat::kQoi},
}};

constexpr std::string_view kTgaFooter = "TRUEVISION-XFILE.\0"sv;

char Lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

bool HasEnding(std::string_view name, std::string_view ending) {
  if (name.size() < ending.size()) return false;
  const std::string_view tail = name.substr(name.size() - ending.size());
  return std::equal(tail.begin(), tail.end(), ending.begin(),
                    [](char a, char b) { return Lower(a) == Lower(b); });
}

ImageFormat FormatOfEnding(std::string_view name) {
  for (const auto& [ending, format] : kEndings) {
    if (HasEnding(name, ending)) return format;
  }
  return ImageFormat::kUnknown;
}

ImageFormat FormatOfContent(std::string_view bytes, std::string_view name) {
  // A TGA may begin with any byte, so its own marks are looked at before the short magic words of others.
  const bool has_tga_footer =
      bytes.size() > kTgaFooter.size() && bytes.substr(bytes.size() - kTgaFooter.size()) == kTgaFooter;
  if (has_tga_footer) return ImageFormat::kTga;
  for (const auto& [magic, format] : kMagic) {
    if (bytes.starts_with(magic)) return format;
  }
  if (bytes.size() >= 12 && bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP")
    return ImageFormat::kWebp;
  return FormatOfEnding(name) == ImageFormat::kTga ? ImageFormat::kTga : ImageFormat::kUnknown;
}

std::string_view FormatName(ImageFormat format) {
  switch (format) {
    case ImageFormat::kExr: return "OpenEXR";
    case ImageFormat::kPng: return "PNG";
    case ImageFormat::kJpeg: return "JPEG";
    case ImageFormat::kTga: return "TGA";
    case ImageFormat::kHdr: return "Radiance HDR";
    case ImageFormat::kTiff: return "TIFF";
    case ImageFormat::kBmp: return "BMP";
    case ImageFormat::kWebp: return "WebP";
    case ImageFormat::kPfm: return "PFM";
    case ImageFormat::kQoi: return "QOI";
    case ImageFormat::kUnknown: break;
  }
  return "unknown";
}

}  // namespace tessera
