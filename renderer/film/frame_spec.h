// What a frame is: size, samples, channels and the header of its file. Decided once, at submission.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/film/channel.h"
#include "renderer/film/channel_layout.h"
#include "renderer/film/sample_range.h"
#include "renderer/util/result.h"

namespace tessera {

constexpr int kResolutionMax = 1 << 16;  // pixels per axis: the limit of common OpenEXR readers
constexpr int kTileSizeMax = 256;        // pixels: a unit's result stays far below the message limit
constexpr int kTileSizeDefault = 32;     // pixels: small enough to share 192x108 over 8 threads
constexpr int64_t kFramePixelsMax = int64_t{1} << 28;  // of one crop: 16k x 16k, a few GB of sums
constexpr int64_t kTileCountMax = int64_t{1} << 22;    // bounds the bookkeeping of a frame
constexpr size_t kAttributesMax = 64;
// Attributes in the header of a picture.
constexpr const char* kSamplesAttribute = "tessera:samplesPerPixel";
constexpr const char* kSamplerAttribute = "tessera:sampler";
constexpr size_t kAttributeSizeMax = 1 << 16;  // bytes of one name and its value

// Pixels [x0, x1) x [y0, y1).
struct PixelBounds {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  auto operator<=>(const PixelBounds&) const = default;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  int64_t area() const { return static_cast<int64_t>(width()) * height(); }
};

enum class ExrType { kHalf, kFloat };

// How the colours of a complete frame lose their noise before they are written (renderer/denoise). The
// numbers are stored and sent.
enum class Denoiser : uint32_t { kNone = 0, kRegression = 1, kOidn = 2 };
constexpr Denoiser kDenoiserLast = Denoiser::kOidn;
inline constexpr std::string_view kDenoiserNames[] = {"none", "regression", "oidn"};  // by number

constexpr double kNoiseThresholdMax = 1;  // no estimate is larger: film/adaptive.h

// Immutable after Check.
struct FrameSpec {
  int width = 0, height = 0;  // of the whole picture: the display window
  PixelBounds crop;           // what is rendered: the data window
  uint32_t samples_per_pixel = 0;
  int tile_size = kTileSizeDefault;
  std::vector<Channel> channels = ColorsAndWeight({"R", "G", "B"});
  ExrType exr_type = ExrType::kHalf;
  // Pixels whose noise is below this stop early (film/adaptive.h); 0: every pixel gets all samples.
  double noise_threshold = 0;
  Denoiser denoiser = Denoiser::kNone;
  uint32_t cryptomatte_levels = kCryptomatteLevelsDefault;  // of the channels of ids, if there are any
  std::map<std::string, std::string> attributes;  // of the EXR header; nothing that differs between runs

  bool operator==(const FrameSpec&) const = default;
  // Returns an error that names the first value beyond its limits.
  Result<void> Check() const;
  bool IsAdaptive() const { return noise_threshold > 0; }
  // Makes the frame adaptive if the threshold is above 0: it then counts the samples of its pixels.
  void SetNoiseThreshold(double threshold);
  ChannelLayout Layout() const { return {channels, IsAdaptive()}; }
  std::vector<PictureChannel> PictureChannels() const;
  // Tiles cover the crop row by row; the last of a row or column may be smaller.
  int TileCount() const;
  PixelBounds TileBounds(int tile) const;
};

}  // namespace tessera
