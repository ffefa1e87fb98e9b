#include "renderer/film/picture_format.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace tessera {
namespace {

constexpr std::string_view kCompressionNames[] = {"none",  "rle", "zips", "zip",  "piz",
                                                  "pxr24", "b44", "b44a", "dwaa", "dwab"};

// Whether DWA takes the channel for a colour, whatever its layer.
bool IsColorForDwa(std::string_view channel) {
  constexpr std::string_view kColors[] = {"r",   "red",  "g", "grn", "green", "b",
                                          "blu", "blue", "y", "by",  "ry"};
  std::string last(channel.substr(channel.rfind('.') + 1));
  std::ranges::transform(last, last.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::find(kColors, last) != std::end(kColors);
}

}  // namespace

std::span<const std::string_view> ExrCompressionNames() {
  return kCompressionNames;
}

std::string_view NameOf(ExrCompression compression) {
  return kCompressionNames[static_cast<size_t>(compression)];
}

std::optional<ExrCompression> ExrCompressionOf(std::string_view name) {
  const auto* const found = std::ranges::find(kCompressionNames, name);
  if (found == std::end(kCompressionNames)) return std::nullopt;
  return static_cast<ExrCompression>(found - std::begin(kCompressionNames));
}

bool MayChange(ExrCompression compression, std::string_view channel, ExrType type) {
  switch (compression) {
    case ExrCompression::kNone:
    case ExrCompression::kRle:
    case ExrCompression::kZips:
    case ExrCompression::kZip:
    case ExrCompression::kPiz: return false;
    case ExrCompression::kPxr24: return type == ExrType::kFloat;
    case ExrCompression::kB44:
    case ExrCompression::kB44a: return type == ExrType::kHalf;
    case ExrCompression::kDwaa:
    case ExrCompression::kDwab: return IsColorForDwa(channel);
  }
  return true;
}

}  // namespace tessera
