#include "renderer/image/library_formats.h"

#include <cstring>
#include <exception>

#include <fmt/format.h>
#include <immintrin.h>

#include "renderer/exr/exr_header.h"
#include "renderer/formats/loader/module_loader.h"
#include "renderer/image/bmp_masks.h"
#include "renderer/image/container_check.h"
#include "renderer/image/declared_size.h"
#include "renderer/image/image_limits.h"
#include "renderer/image/orientation.h"
#include "renderer/image/radiance_runs.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

using image_module::ValueType;

const char* PluginName(ImageFormat format) {
  switch (format) {
    case ImageFormat::kExr: return "openexr";
    case ImageFormat::kPng: return "png";
    case ImageFormat::kJpeg: return "jpeg";
    case ImageFormat::kTga: return "targa";
    case ImageFormat::kHdr: return "hdr";
    case ImageFormat::kTiff: return "tiff";
    case ImageFormat::kBmp: return "bmp";
    case ImageFormat::kWebp: return "webp";
    case ImageFormat::kPfm:
    case ImageFormat::kQoi:
    case ImageFormat::kUnknown: break;  // not decoded by a library
  }
  return "";
}

Error Damaged(const std::string& name, ImageFormat format, std::string_view reason) {
  // Libraries add further lines that say less.
  const std::string why = OneLine(reason.substr(0, reason.find('\n')));
  return BadInput(
      fmt::format("{}: damaged {} picture{}{}", name, FormatName(format), why.empty() ? "" : ": ", why));
}

size_t SizeOf(ValueType type) {
  switch (type) {
    case ValueType::kUint8: return 1;
    case ValueType::kUint16:
    case ValueType::kHalf: return 2;
    case ValueType::kFloat: break;
  }
  return 4;
}

// 16-bit integers become halves.
PixelFormat FormatOf(ValueType type) {
  if (type == ValueType::kUint8) return PixelFormat::kUint8;
  return type == ValueType::kFloat ? PixelFormat::kFloat : PixelFormat::kHalf;
}

// Turns 16-bit integers into linear halves, in place.
void DecodeUint16(std::vector<uint8_t>& bytes, const ColorEncoding& encoding) {
  for (size_t i = 0; i + 1 < bytes.size(); i += 2) {
    uint16_t value;
    std::memcpy(&value, &bytes[i], sizeof value);
    const uint16_t half =
        _cvtss_sh(encoding.ToLinear(static_cast<float>(value) / 65535.0f), _MM_FROUND_TO_NEAREST_INT);
    std::memcpy(&bytes[i], &half, sizeof half);
  }
}

// Keeps the first `kept` channels of every pixel.
void DropChannels(Image& image, int kept) {
  const size_t value_size = image.format == PixelFormat::kUint8  ? 1
                            : image.format == PixelFormat::kHalf ? 2
                                                                 : 4;
  const size_t pixels = static_cast<size_t>(image.width) * image.height;
  for (size_t i = 0; i < pixels; ++i) {
    std::memmove(&image.bytes[i * kept * value_size], &image.bytes[i * image.channels * value_size],
                 kept * value_size);
  }
  image.bytes.resize(pixels * kept * value_size);
  image.channels = kept;
  image.channel_names.resize(kept);
}

// Whether a PNG, already checked, stores alpha in each pixel. The library also makes an alpha channel of a
// transparent colour and of transparent entries of a palette.
bool StoresAlpha(const std::string& png) {
  constexpr size_t kColorTypeAt = 25;
  constexpr char kAlphaUsed = 4;  // one bit of the colour type
  return (png[kColorTypeAt] & kAlphaUsed) != 0;
}

// Whether pbrt reads the alpha of such a file: it has none of what it reads with stb_image, and only the one
// that a PNG stores in its pixels.
bool HasAlphaInPbrt(ImageFormat format, const std::string& bytes) {
  if (format == ImageFormat::kPng) return StoresAlpha(bytes);
  return format != ImageFormat::kTga && format != ImageFormat::kBmp;
}

void DropAlphaAsPbrt(ImageFormat format, const std::string& bytes, Image& image) {
  if (HasAlphaInPbrt(format, bytes)) return;
  if (image.channels == 2 || image.channels == 4) DropChannels(image, image.channels - 1);
  if (image.channels == 1) image.channel_names = {"Y"};
}

// Of the pixels as the library returns them.
Orientation OrientationOf(const image_module::PictureInfo& info, ImageFormat format,
                          const std::string& bytes) {
  std::optional<Orientation> orientation;
  // The library confuses two of the eight.
  if (format == ImageFormat::kHdr) orientation = OrientationOfRadiance(bytes);
  if (format == ImageFormat::kTiff) orientation = OrientationOfTag(info.orientation);
  return orientation.value_or(Orientation{});
}

std::optional<Chromaticities> ChromaticitiesOf(const image_module::PictureInfo& info, ImageFormat format) {
  if (format != ImageFormat::kExr || info.has_chromaticities == 0) return std::nullopt;
  const float* const xy = info.chromaticities;
  return Chromaticities{{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}};
}

Result<Image> Decode(ImageFormat format, const std::string& bytes, const std::string& name,
                     std::optional<ColorEncoding> encoding) {
  const auto library = image_module::Load();
  if (!library) return Failed(fmt::format("{}: {}", name, library.error().message));
  image_module::PictureInfo info{};
  image_module::Reason reason{};
  const image_module::PictureHandle picture(
      (*library)->open({PluginName(format), name.c_str(), bytes.data(), bytes.size(),
                        static_cast<int32_t>(kImageChannelsMax), static_cast<int32_t>(kImageBytesMax >> 20)},
                       info, reason),
      {(*library)->close});
  if (reason.is_unsupported_format != 0)
    return BadInput(fmt::format("{}: this build cannot read {} pictures", name, FormatName(format)));
  if (!picture) return Damaged(name, format, reason.text);
  if (info.is_deep_or_volume != 0)
    return BadInput(fmt::format("{}: deep and volume pictures are not supported", name));
  const size_t value_size = SizeOf(info.type);
  const Result<void> size = CheckImageSize(name, info.width, info.height, info.channels,
                                           static_cast<int64_t>(value_size), bytes.size());
  if (!size) return size.error();

  Image image;
  image.width = info.width;
  image.height = info.height;
  image.channels = info.channels;
  image.format = FormatOf(info.type);
  image.encoding = encoding.value_or(ColorEncoding{ColorEncoding::Kind::kSrgb, 1});
  image.channel_names.assign(info.channel_names, info.channel_names + info.channels);
  image.bytes.resize(static_cast<size_t>(info.width) * info.height * info.channels * value_size);
  if (!(*library)->read(picture.get(), image.bytes.data(), reason)) return Damaged(name, format, reason.text);
  if (info.type == ValueType::kUint16) DecodeUint16(image.bytes, image.encoding);
  if (image.channels == 1) image.channel_names = {"Y"};
  image.chromaticities = ChromaticitiesOf(info, format);
  DropAlphaAsPbrt(format, bytes, image);
  MakeUpright(image, OrientationOf(info, format, bytes));
  return image;
}

// Whether the structure of an OpenEXR file is intact and the picture has an allowed size.
Result<void> CheckTexture(const std::string& bytes, const std::string& name) {
  constexpr int64_t kHalfSize = 2;  // the smallest value
  return CheckExr(bytes, name, [&](int64_t width, int64_t height, int64_t channels) {
    return CheckImageSize(name, width, height, channels, kHalfSize, bytes.size());
  });
}

// What the library reads correctly instead of the file; nullopt if that is the file itself.
Result<std::optional<std::string>> Substitute(ImageFormat format, const std::string& bytes,
                                              const std::string& name) {
  if (format == ImageFormat::kBmp) return WithStandardMasks(bytes, name);
  if (format == ImageFormat::kHdr) return WithoutOldRuns(bytes, name);
  return std::optional<std::string>();
}

}  // namespace

Result<Image> DecodeWithLibrary(ImageFormat format, const std::string& bytes, const std::string& name,
                                std::optional<ColorEncoding> encoding) {
  Result<void> checked = CheckDeclaredSize(format, bytes, name);
  if (!checked) return checked.error();
  if (format == ImageFormat::kExr) checked = CheckTexture(bytes, name);
  if (format == ImageFormat::kPng) checked = CheckPng(bytes, name);
  if (format == ImageFormat::kJpeg) checked = CheckJpeg(bytes, name);
  if (format == ImageFormat::kBmp) checked = CheckBmp(bytes, name);
  if (!checked) return checked.error();
  const auto substitute = Substitute(format, bytes, name);
  if (!substitute) return substitute.error();
  try {
    return Decode(format, *substitute ? **substitute : bytes, name, encoding);
  } catch (const std::exception& exception) {
    return Damaged(name, format, exception.what());
  } catch (...) {
    return Damaged(name, format, "");
  }
}

}  // namespace tessera
