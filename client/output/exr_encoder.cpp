#include "client/output/exr_encoder.h"

#include <fmt/format.h>

#include <algorithm>

namespace tessera {
namespace {

constexpr const char* kWeightName = "filter weight";  // is not written; no channel of ours has this name

Channel ChannelOf(const std::string& name) {
  if (name == kSamplesChannel) return SamplesChannel(true);
  const std::string noisy = "noisy.";
  const bool is_color = IsColorChannel(name.starts_with(noisy) ? name.substr(noisy.size()) : name);
  return {name, is_color ? ChannelType::kColor : ChannelType::kFloat, MergeRule::kSum};
}

}  // namespace

Result<std::string> EncodeLoaded(const LoadedPicture& picture, ExrType type, const std::string& path) {
  FrameSpec spec;
  spec.width = picture.width;
  spec.height = picture.height;
  spec.crop = picture.bounds;
  spec.samples_per_pixel = 1;
  spec.tile_size = kTileSizeMax;
  spec.exr_type = type;
  spec.attributes = picture.attributes;
  spec.channels.clear();
  for (const std::string& name : picture.channels) spec.channels.push_back(ChannelOf(name));
  spec.channels.push_back({kWeightName, ChannelType::kWeight, MergeRule::kSum, false});
  FramePicture frame;
  frame.bounds = picture.bounds;
  frame.channels = picture.channels;
  frame.values = picture.values;
  auto bytes = EncodeExr(spec, frame);
  if (!bytes) return Error{bytes.error().kind, fmt::format("{}: {}", path, bytes.error().message)};
  return bytes;
}

}  // namespace tessera
