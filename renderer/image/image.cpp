#include "renderer/image/image.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <immintrin.h>

#include "renderer/image/color_encoding.h"
#include "renderer/image/image_format.h"
#include "renderer/image/image_limits.h"
#include "renderer/image/library_formats.h"
#include "renderer/image/pfm.h"
#include "renderer/image/qoi.h"

namespace tessera {

float ColorEncoding::ToLinear(float value) const {
  switch (kind) {
    case Kind::kLinear: return value;
    case Kind::kGamma: return std::pow(value, gamma);
    case Kind::kSrgb: break;
  }
  if (value <= 0.04045f) return value * (1 / 12.92f);
  return std::pow((value + 0.055f) * (1 / 1.055f), 2.4f);
}

std::array<float, 256> DecodingTable(const ColorEncoding& encoding) {
  std::array<float, 256> table;
  for (int i = 0; i < 256; ++i) table[i] = encoding.ToLinear(static_cast<float>(i) / 255.0f);
  return table;
}

float Image::Get(int x, int y, int channel) const {
  const size_t index = (static_cast<size_t>(y) * width + x) * channels + channel;
  switch (format) {
    case PixelFormat::kUint8: {
      static const std::array<float, 256> srgb = DecodingTable({ColorEncoding::Kind::kSrgb, 1});
      const uint8_t value = bytes[index];
      return encoding.kind == ColorEncoding::Kind::kSrgb ? srgb[value] : encoding.ToLinear(value / 255.0f);
    }
    case PixelFormat::kHalf: {
      uint16_t half;
      std::memcpy(&half, &bytes[index * 2], sizeof half);
      return _cvtsh_ss(half);
    }
    case PixelFormat::kFloat: break;
  }
  float value;
  std::memcpy(&value, &bytes[index * 4], sizeof value);
  return value;
}

int Image::ChannelIndex(std::string_view name) const {
  for (size_t i = 0; i < channel_names.size(); ++i) {
    if (channel_names[i] == name) return static_cast<int>(i);
  }
  return -1;
}

std::optional<std::array<int, 3>> Image::RgbChannels() const {
  const std::array<int, 3> rgb{ChannelIndex("R"), ChannelIndex("G"), ChannelIndex("B")};
  if (rgb[0] < 0 || rgb[1] < 0 || rgb[2] < 0) return std::nullopt;
  return rgb;
}

namespace {

// pbrt chooses a reader of these by the name's ending alone, so a file of another format is a mistake; any
// other ending it leaves to the content.
bool EndingDecides(ImageFormat format) {
  return format == ImageFormat::kExr || format == ImageFormat::kPng || format == ImageFormat::kPfm ||
         format == ImageFormat::kHdr || format == ImageFormat::kQoi;
}

Result<ImageFormat> RecogniseFormat(const std::string& bytes, const std::string& name) {
  const ImageFormat content = FormatOfContent(bytes, name);
  const ImageFormat ending = FormatOfEnding(name);
  if (bytes.empty()) return BadInput(fmt::format("{}: the file is empty, expected a picture", name));
  if (content == ImageFormat::kUnknown && ending == ImageFormat::kUnknown) {
    return BadInput(fmt::format(
        "{}: not a picture of a known format, expected EXR, PNG, JPEG, TGA, HDR, TIFF, BMP, WebP, PFM or QOI",
        name));
  }
  if (content == ImageFormat::kUnknown) {
    return BadInput(
        fmt::format("{}: damaged picture: it does not begin as a {} file does", name, FormatName(ending)));
  }
  if (content != ending && EndingDecides(ending)) {
    return BadInput(fmt::format("{}: holds a {} picture, but its name says {}", name, FormatName(content),
                                FormatName(ending)));
  }
  return content;
}

Result<Image> DecodeFormat(const std::string& bytes, const std::string& name,
                           std::optional<ColorEncoding> encoding) {
  const Result<ImageFormat> format = RecogniseFormat(bytes, name);
  if (!format) return format.error();
  switch (*format) {
    case ImageFormat::kPfm: return DecodePfm(bytes, name);
    case ImageFormat::kQoi: return DecodeQoi(bytes, name, encoding);
    case ImageFormat::kExr:
    case ImageFormat::kPng:
    case ImageFormat::kJpeg:
    case ImageFormat::kTga:
    case ImageFormat::kHdr:
    case ImageFormat::kTiff:
    case ImageFormat::kBmp:
    case ImageFormat::kWebp:
    case ImageFormat::kUnknown: break;
  }
  return DecodeWithLibrary(*format, bytes, name, encoding);
}

std::string CacheKey(const std::string& name, const std::optional<ColorEncoding>& encoding) {
  return name + '\n' + EncodingText(encoding);
}

}  // namespace

std::string EncodingText(const std::optional<ColorEncoding>& encoding) {
  if (!encoding) return "default";
  return fmt::format("{} {}", static_cast<int>(encoding->kind), encoding->gamma);
}

ImageSize SizeOf(const Image& image) {
  return {image.file_bytes, image.bytes.size()};
}

Result<Image> DecodeImage(const std::string& bytes, const std::string& name,
                          std::optional<ColorEncoding> encoding) {
  Result<Image> image = DecodeFormat(bytes, name, encoding);
  if (image) image->file_bytes = bytes.size();
  return image;
}

Result<std::shared_ptr<const Image>> ImageCache::Get(const std::string& name,
                                                     std::optional<ColorEncoding> encoding) {
  const std::string key = CacheKey(name, encoding);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (const auto found = images_.find(key); found != images_.end()) return found->second;
  const std::string what = "image " + EncodingText(encoding);
  auto shared = files_.Recall<Image>(name, what);
  const bool is_recalled = shared != nullptr;
  if (!is_recalled) {
    const Result<std::string> bytes = files_.Read(name);
    if (!bytes) return bytes.error();
    Result<Image> image = DecodeImage(*bytes, name, encoding);
    if (!image) return image.error();
    shared = std::make_shared<const Image>(std::move(image).value());
  }
  if (Result<void> counted = Count(key, name, SizeOf(*shared)); !counted) return counted.error();
  if (!is_recalled) files_.Keep(name, what, shared, shared->bytes.size());
  images_.emplace(key, shared);
  return shared;
}

Result<void> ImageCache::CountRecalled(const std::string& name, const std::optional<ColorEncoding>& encoding,
                                       const ImageSize& size) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return Count(CacheKey(name, encoding), name, size);
}

Result<void> ImageCache::Count(const std::string& key, const std::string& name, const ImageSize& size) {
  if (counted_.insert(key).second) {
    sum_.file_bytes += size.file_bytes;
    sum_.decoded_bytes += size.decoded_bytes;
  }
  const uint64_t allowed = std::max<uint64_t>(bytes_floor_, sum_.file_bytes * kImagesExpansionMax);
  if (sum_.decoded_bytes <= allowed) return {};
  return BadInput(
      fmt::format("{}: the pictures up to this one hold {} bytes when decoded, at most {} are read from "
                  "files of {} bytes",
                  name, sum_.decoded_bytes, allowed, sum_.file_bytes));
}

RgbSummary Summarize(const Image& image) {
  const std::optional<std::array<int, 3>> channels = image.RgbChannels();
  RgbSummary summary;
  double sum[3] = {};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (size_t c = 0; c < 3; ++c) {
        const float value = image.Get(x, y, (*channels)[c]);
        summary.is_finite &= std::isfinite(value);
        sum[c] += std::min(kEmissionMax, std::max(0.0f, value));
      }
    }
  }
  const double count = static_cast<double>(image.width) * image.height;
  for (int c = 0; c < 3; ++c) summary.mean[c] = static_cast<float>(sum[c] / count);
  return summary;
}

const RgbSummary& ImageCache::Summary(const std::shared_ptr<const Image>& image) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = summaries_.find(image);
  return found != summaries_.end() ? found->second
                                   : summaries_.emplace(image, Summarize(*image)).first->second;
}

size_t ImageCache::summaries() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return summaries_.size();
}

size_t ImageCache::bytes() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  size_t sum = 0;
  for (const auto& [key, image] : images_) sum += image->bytes.size();
  return sum;
}

}  // namespace tessera
