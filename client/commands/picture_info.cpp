#include "client/commands/picture_info.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "client/output/layer_files.h"
#include "proto/shell/console.h"
#include "renderer/film/picture_file.h"
#include "renderer/text/unicode.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr uint64_t kPictureFileBytesMax = uint64_t{8} << 30;
constexpr size_t kShownBytesMax = 160;  // of an attribute, as text: manifests of mattes have thousands
constexpr std::string_view kMatteNames = "/manifest";

using FileChannel = PictureHeader::FileChannel;

std::map<std::string, std::vector<FileChannel>> LayersOf(const PictureHeader& header) {
  std::vector<std::string> mattes;
  for (const auto& attribute : header.attributes) {
    if (attribute.name.starts_with("cryptomatte/") && attribute.name.ends_with("/name"))
      mattes.push_back(attribute.text);
  }
  std::map<std::string, std::vector<FileChannel>> layers;
  for (const FileChannel& channel : header.channels) layers[LayerOf(channel.name, mattes)].push_back(channel);
  return layers;
}

// How many names a manifest of mattes holds: one that is no JSON has none.
size_t NameCount(const std::string& manifest) {
  const auto json = nlohmann::json::parse(manifest, nullptr, false);
  return json.is_object() ? json.size() : 0;
}

std::string Shown(const PictureHeader::Attribute& attribute) {
  if (attribute.name.starts_with("cryptomatte/") && attribute.name.ends_with(kMatteNames))
    return fmt::format("{} names", NameCount(attribute.text));
  const bool is_cut = attribute.text.size() > kShownBytesMax;
  return CleanText(attribute.text, kShownBytesMax) + (is_cut ? "..." : "");
}

std::string LayoutText(const ExrFormat& format) {
  return format.is_tiled ? "tiles" : "scanlines";
}

void PrintText(const PictureHeader& header) {
  const PixelBounds& crop = header.bounds;
  fmt::print("picture     {}x{} pixels", header.width, header.height);
  if (crop != PixelBounds{0, 0, header.width, header.height})
    fmt::print(", of which {},{} to {},{}", crop.x0, crop.y0, crop.x1, crop.y1);
  fmt::print("\ncompression {}\nlayout      {}\n", NameOf(header.format.compression),
             LayoutText(header.format));
  if (header.format.has_preview)
    fmt::print("preview     {}x{}\n", header.preview_width, header.preview_height);
  fmt::print("layers\n");
  for (const auto& [layer, channels] : LayersOf(header)) {
    std::string names;
    for (const FileChannel& channel : channels) {
      const std::string name = channel.name.substr(channel.name.rfind('.') + 1);
      names += fmt::format(" {}", CleanText(channels.size() > 4 ? channel.name : name, kShownBytesMax));
    }
    fmt::print("  {}:{} ({})\n", layer.empty() ? "colours" : CleanText(layer, kShownBytesMax), names,
               channels.front().type);
  }
  fmt::print("attributes\n");
  for (const auto& attribute : header.attributes)
    fmt::print("  {} ({}): {}\n", CleanText(attribute.name, kShownBytesMax), attribute.type,
               Shown(attribute));
}

void PrintJson(const PictureHeader& header) {
  nlohmann::ordered_json json;
  json["width"] = header.width;
  json["height"] = header.height;
  json["window"] = {header.bounds.x0, header.bounds.y0, header.bounds.x1, header.bounds.y1};
  json["compression"] = NameOf(header.format.compression);
  json["layout"] = LayoutText(header.format);
  json["preview"] = nullptr;
  if (header.format.has_preview) json["preview"] = {header.preview_width, header.preview_height};
  json["layers"] = nlohmann::ordered_json::array();
  for (const auto& [layer, channels] : LayersOf(header)) {
    nlohmann::ordered_json entry{{"layer", layer}, {"channels", nlohmann::ordered_json::array()}};
    for (const FileChannel& channel : channels)
      entry["channels"].push_back({{"name", channel.name}, {"type", channel.type}});
    json["layers"].push_back(std::move(entry));
  }
  json["attributes"] = nlohmann::ordered_json::array();
  for (const auto& attribute : header.attributes)
    json["attributes"].push_back(
        {{"name", attribute.name}, {"type", attribute.type}, {"value", attribute.text}});
  fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace

bool IsPictureFile(const std::string& path) {
  // Not blocking: a pipe is no picture and must not be waited for.
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (file < 0) return false;
  char start[4];
  const ssize_t got = ::pread(file, start, sizeof start, 0);  // takes nothing from a pipe
  ::close(file);
  return got == sizeof start && IsExr({start, sizeof start});
}

Result<void> PrintPictureInfo(const std::string& path, bool json) {
  const auto bytes = ReadFile(path, kPictureFileBytesMax);
  if (!bytes) return bytes.error();
  const auto header = ReadExrHeader(*bytes, path);
  if (!header) return header.error();
  if (json) {
    PrintJson(*header);
  } else {
    PrintText(*header);
  }
  return {};
}

}  // namespace tessera
