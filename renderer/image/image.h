// Pictures read from files: textures, environment maps, normal maps.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "renderer/description/file_source.h"
#include "renderer/image/image_limits.h"
#include "renderer/math/vec.h"
#include "renderer/util/result.h"

namespace tessera {

enum class PixelFormat { kUint8, kHalf, kFloat };

// How stored 8-bit values become linear ones.
struct ColorEncoding {
  enum class Kind { kLinear, kSrgb, kGamma };
  Kind kind = Kind::kLinear;
  float gamma = 1;
  bool operator==(const ColorEncoding&) const = default;
  float ToLinear(float value) const;  // value in [0, 1]
};

// The CIE xy of the primaries and of the white of RGB values.
struct Chromaticities {
  Point2 red, green, blue, white;
  bool operator==(const Chromaticities&) const = default;
};

// A picture in memory, rows from top to bottom, channels interleaved. Immutable once read.
struct Image {
  int width = 0, height = 0, channels = 0;
  PixelFormat format = PixelFormat::kFloat;
  ColorEncoding encoding;  // of kUint8 data
  // Of R, G and B, if the file names them. As in pbrt, only OpenEXR files do: the gamma and the
  // chromaticities of a PNG or Radiance file and the Exif data of a JPEG file change nothing.
  std::optional<Chromaticities> chromaticities;
  std::vector<std::string> channel_names;  // "R", "G", "B", "A", "Y", ... as the file names them
  std::vector<uint8_t> bytes;              // width * height * channels values of `format`, machine byte order
  uint64_t file_bytes = 0;                 // of the file that it was decoded from

  // The linear value of a channel; x and y must be inside.
  float Get(int x, int y, int channel) const;
  // Index of the channel of this name, -1 if there is none.
  int ChannelIndex(std::string_view name) const;
  // Indices of R, G and B. Returns nullopt if the picture lacks one of them.
  std::optional<std::array<int, 3>> RgbChannels() const;
};

// The largest value of a pixel of a light that counts: the sum of the largest pictures stays finite.
constexpr float kEmissionMax = 1e25f;

// What lights need to know of a picture that they emit, which has R, G and B.
struct RgbSummary {
  bool is_finite = true;  // every value
  Vec3 mean;              // negative values count as 0, those beyond kEmissionMax as that
};
RgbSummary Summarize(const Image& image);

// Reads EXR, PNG, JPEG, TGA, HDR, TIFF, BMP, WebP, PFM and QOI, decided by content and checked against
// `name`'s ending; sizes are bounded. Radiance and TIFF pictures of any orientation become upright.
// `encoding` is for 8-bit data, which is sRGB without one.
Result<Image> DecodeImage(const std::string& bytes, const std::string& name,
                          std::optional<ColorEncoding> encoding);

// A different text for each encoding, for cache keys.
std::string EncodingText(const std::optional<ColorEncoding>& encoding);

// What a picture counts for in the limit of all pictures of a scene.
struct ImageSize {
  uint64_t file_bytes = 0, decoded_bytes = 0;
};
ImageSize SizeOf(const Image& image);

// Images by file name and encoding, each read once, and together no larger than image_limits.h allows. Those
// that the file source recalls count as those that are decoded, so a scene is refused on every machine or on
// none. Thread safe.
class ImageCache {
 public:
  explicit ImageCache(FileSource& files, uint64_t bytes_floor = kImagesBytesFloor)
      : files_(files), bytes_floor_(bytes_floor) {}
  FileSource& files() { return files_; }
  Result<std::shared_ptr<const Image>> Get(const std::string& name, std::optional<ColorEncoding> encoding);
  // Counts an image of which the file source recalls something else that was made of it. An error if it
  // exceeds the limit.
  Result<void> CountRecalled(const std::string& name, const std::optional<ColorEncoding>& encoding,
                             const ImageSize& size);
  // That of a picture of this cache, computed once for all lights that emit it.
  const RgbSummary& Summary(const std::shared_ptr<const Image>& image);
  size_t summaries() const;  // computed
  size_t bytes() const;      // of all pictures held

 private:
  Result<void> Count(const std::string& key, const std::string& name, const ImageSize& size);

  FileSource& files_;
  const uint64_t bytes_floor_;
  // Guarded by mutex_.
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const Image>> images_;
  std::map<std::shared_ptr<const Image>, RgbSummary> summaries_;
  std::set<std::string> counted_;  // keys, as in images_
  ImageSize sum_;                  // of those that are counted
};

}  // namespace tessera
