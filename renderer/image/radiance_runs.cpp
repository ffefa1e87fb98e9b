#include "renderer/image/radiance_runs.h"

#include <cstdint>
#include <string_view>

#include <fmt/format.h>

#include "renderer/image/declared_size.h"
#include "renderer/image/image_limits.h"

namespace tessera {
namespace {

constexpr size_t kPixelSize = 4;  // bytes
constexpr std::string_view kRun = "\1\1\1";
constexpr std::string_view kNewRow = "\2\2";  // begins a row of the later encoding, with the row's size
constexpr int kShiftMax = 24;                 // a run of more pixels than 32 bits count has no meaning

// Where the pixels begin: after the resolution line, which follows an empty line.
size_t PixelsStart(std::string_view bytes) {
  const size_t end_of_header = bytes.find("\n\n");
  if (end_of_header == std::string_view::npos) return std::string_view::npos;
  const size_t end_of_line = bytes.find('\n', end_of_header + 2);
  return end_of_line == std::string_view::npos ? end_of_line : end_of_line + 1;
}

bool HasOldRuns(std::string_view pixels) {
  if (pixels.starts_with(kNewRow)) return false;
  for (size_t at = 0; at + kPixelSize <= pixels.size(); at += kPixelSize) {
    if (pixels.substr(at).starts_with(kRun)) return true;
  }
  return false;
}

// Takes the pixels of one row from the front of `encoded` and appends them to `flat`. Returns what is wrong
// with them, or "".
std::string_view AppendRow(std::string_view& encoded, size_t row_size, std::string& flat) {
  const size_t start = flat.size(), end = start + row_size;
  int shift = 0;
  while (flat.size() < end) {
    if (encoded.size() < kPixelSize) return "unexpected end of file";
    const std::string_view pixel = encoded.substr(0, kPixelSize);
    encoded.remove_prefix(kPixelSize);
    if (!pixel.starts_with(kRun)) {
      flat += pixel;
      shift = 0;
      continue;
    }
    const uint64_t count = shift > kShiftMax ? 0 : uint64_t{static_cast<uint8_t>(pixel[3])} << shift;
    if (flat.size() == start || shift > kShiftMax || count > (end - flat.size()) / kPixelSize)
      return "a run of pixels leaves its row";
    const std::string last = flat.substr(flat.size() - kPixelSize);
    for (uint64_t i = 0; i < count; ++i) flat += last;
    shift += 8;
  }
  return "";
}

}  // namespace

Result<std::optional<std::string>> WithoutOldRuns(const std::string& bytes, const std::string& name) {
  const auto size = FindDeclaredSize(ImageFormat::kHdr, bytes);
  const size_t start = PixelsStart(bytes);
  if (!size || start == std::string::npos) return std::optional<std::string>();
  std::string_view encoded = std::string_view(bytes).substr(start);
  if (!HasOldRuns(encoded)) return std::optional<std::string>();
  constexpr int64_t kChannels = 3, kValueSize = 4;  // when decoded
  const Result<void> checked =
      CheckImageSize(name, size->width, size->height, kChannels, kValueSize, bytes.size());
  if (!checked) return checked.error();
  std::string flat = bytes.substr(0, start);
  for (int64_t row = 0; row < size->height; ++row) {
    const std::string_view wrong = AppendRow(encoded, static_cast<size_t>(size->width) * kPixelSize, flat);
    if (!wrong.empty()) return BadInput(fmt::format("{}: damaged Radiance HDR picture: {}", name, wrong));
  }
  return std::optional(std::move(flat));
}

}  // namespace tessera
