#include "coordinator/web/api/picture_format.h"

#include <half.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

enum class Kind : uint8_t { kFrame = 1, kRegion = 2, kState = 3, kProblem = 4 };

constexpr size_t kHeadBytes = 12;
constexpr size_t kRegionHeadBytes = 16;
constexpr float kHalfMax = 65504.0f;  // the largest finite half, as in the files

template <typename Number>
void Append(std::string& bytes, Number number) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string Head(Kind kind, size_t payload) {
  std::string bytes = "TPIX";
  bytes.reserve(kHeadBytes + payload);
  Append(bytes, kPictureFormatVersion);
  Append(bytes, static_cast<uint8_t>(kind));
  Append(bytes, uint16_t{0});
  Append(bytes, static_cast<uint32_t>(payload));
  return bytes;
}

}  // namespace

ColorPlaces FindColors(const std::vector<std::string>& channels) {
  constexpr const char* kNames[] = {"R", "G", "B"};
  ColorPlaces places{};
  for (size_t c = 0; c < places.size(); ++c) {
    const auto found = std::ranges::find(channels, kNames[c]);
    if (found != channels.end()) places[c] = static_cast<size_t>(found - channels.begin());
  }
  return places;
}

PictureShape ShapeOf(const FrameSpec& spec, const PictureLayer& layer, int64_t values_max) {
  PictureShape shape;
  shape.crop = spec.crop;
  shape.frame_width = spec.width;
  shape.frame_height = spec.height;
  shape.type = layer.is_exact ? ExrType::kFloat : spec.exr_type;
  shape.channels = layer.channels.size();
  for (shape.step = 1;; ++shape.step) {
    shape.width = (spec.crop.width() + shape.step - 1) / shape.step;
    shape.height = (spec.crop.height() + shape.step - 1) / shape.step;
    const bool is_least = shape.width == 1 && shape.height == 1;
    if (is_least || int64_t{shape.width} * shape.height * static_cast<int64_t>(shape.channels) <= values_max)
      return shape;
  }
}

std::string FrameMessage(const PictureShape& shape) {
  std::string bytes = Head(Kind::kFrame, 32);
  for (const int number : {shape.width, shape.height, shape.step, shape.crop.x0, shape.crop.y0,
                           shape.frame_width, shape.frame_height})
    Append(bytes, static_cast<uint32_t>(number));
  Append(bytes, static_cast<uint8_t>(shape.type == ExrType::kHalf ? 1 : 2));
  Append(bytes, static_cast<uint8_t>(shape.channels));
  Append(bytes, uint16_t{0});
  return bytes;
}

std::string RegionMessage(const PictureShape& shape, const PixelBounds& bounds) {
  const size_t values = static_cast<size_t>(bounds.area()) * shape.channels * shape.ValueBytes();
  std::string bytes = Head(Kind::kRegion, kRegionHeadBytes + values);
  for (const int number : {bounds.x0, bounds.y0, bounds.width(), bounds.height()})
    Append(bytes, static_cast<uint32_t>(number));
  bytes.append(values, '\0');
  return bytes;
}

void SetPixel(const PictureShape& shape, const PixelBounds& bounds, int x, int y,
              std::span<const float> values, std::string& region) {
  const auto pixel = static_cast<size_t>(y - bounds.y0) * static_cast<size_t>(bounds.width()) +
                     static_cast<size_t>(x - bounds.x0);
  char* const place =
      region.data() + kHeadBytes + kRegionHeadBytes + pixel * shape.channels * shape.ValueBytes();
  if (shape.type == ExrType::kFloat) {
    std::memcpy(place, values.data(), shape.channels * sizeof(float));
    return;
  }
  for (size_t c = 0; c < shape.channels; ++c) {
    const uint16_t bits = half(std::clamp(values[c], -kHalfMax, kHalfMax)).bits();
    std::memcpy(place + c * sizeof bits, &bits, sizeof bits);
  }
}

std::string ProblemMessage(std::string_view reason) {
  const std::string text = CleanText(reason, kProblemBytesMax);
  return Head(Kind::kProblem, text.size()) + text;
}

std::string StateMessage(uint64_t samples_done, uint64_t samples_total, bool is_finished) {
  std::string bytes = Head(Kind::kState, 24);
  Append(bytes, samples_done);
  Append(bytes, samples_total);
  Append(bytes, static_cast<uint64_t>(is_finished ? 1 : 0));
  return bytes;
}

}  // namespace tessera
