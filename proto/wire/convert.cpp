#include "proto/wire/convert.h"

#include <fmt/format.h>

#include "proto/terms.pb.h"
#include "proto/wire/fields.h"
#include "proto/work.pb.h"
#include "renderer/film/tile_limit.h"
#include "renderer/text/unicode.h"

namespace tessera {

Result<Digest> ReadDigest(const std::string& bytes, const char* field) {
  Digest digest;
  if (bytes.size() != digest.bytes.size()) return BadField(field, "is not a digest of 32 bytes");
  std::copy(bytes.begin(), bytes.end(), digest.bytes.begin());
  return digest;
}

std::string WriteDigest(const Digest& digest) {
  return std::string(digest.bytes.begin(), digest.bytes.end());
}

std::string CleanReason(const std::string& text) {
  return CleanText(text, kReasonBytesMax);
}

std::string CleanName(const std::string& text) {
  // What is far too long is cut before it is normalised.
  return CleanText(Normalize(CleanText(text, 4 * kNameBytesMax)), kNameBytesMax);
}

Result<PixelBounds> ReadPixelBounds(const proto::PixelBounds& message) {
  const PixelBounds bounds{message.x0(), message.y0(), message.x1(), message.y1()};
  const bool ordered = bounds.x0 >= 0 && bounds.y0 >= 0 && bounds.x0 < bounds.x1 && bounds.y0 < bounds.y1;
  if (!ordered || bounds.x1 > kResolutionMax || bounds.y1 > kResolutionMax)
    return BadField("bounds", "are not pixels");
  return bounds;
}

void Write(const PixelBounds& value, proto::PixelBounds& message) {
  message.set_x0(value.x0);
  message.set_y0(value.y0);
  message.set_x1(value.x1);
  message.set_y1(value.y1);
}

Result<SampleRange> ReadSampleRange(const proto::SampleRange& message) {
  const SampleRange range{message.begin(), message.size()};
  if (!range.IsDyadic()) return BadField("range", "is not dyadic");
  return range;
}

void Write(SampleRange value, proto::SampleRange& message) {
  message.set_begin(value.begin);
  message.set_size(value.size);
}

namespace {

Result<Channel> ReadChannel(const proto::Channel& message) {
  if (!IsText(message.name(), kNameBytesMax)) return BadField("channel", "is not a name");
  if (message.type() > static_cast<uint32_t>(kChannelTypeLast))
    return BadField("channel", "is of an unknown type");
  if (message.merge_rule() > static_cast<uint32_t>(MergeRule::kIdWeights))
    return BadField("channel", "has an unknown merge rule");
  return Channel{message.name(), static_cast<ChannelType>(message.type()),
                 static_cast<MergeRule>(message.merge_rule()), message.is_written()};
}

Result<void> ReadChannels(const proto::FrameSpec& message, FrameSpec& spec) {
  if (message.channels_size() > kChannelsMax || message.channel_names_size() > kChannelsMax)
    return BadField("channels", "are too many");
  spec.channels.clear();
  for (const proto::Channel& channel : message.channels()) {
    auto read = ReadChannel(channel);
    if (!read) return read.error();
    spec.channels.push_back(std::move(*read));
  }
  if (!spec.channels.empty()) return {};
  for (const std::string& name : message.channel_names()) {
    if (!IsText(name, kNameBytesMax)) return BadField("channel", "is not a name");
  }
  spec.channels = ChannelsFromNames({message.channel_names().begin(), message.channel_names().end()},
                                    message.writes_samples());
  return {};
}

Result<void> ReadAttributes(const proto::FrameSpec& message, FrameSpec& spec) {
  size_t bytes = 0;
  for (const auto& [name, value] : message.attributes()) {
    bytes += name.size() + value.size();
    if (!IsText(name, kNameBytesMax) || name.empty()) return BadField("attribute", "has no proper name");
    if (bytes > kAttributesBytesMax) return BadField("attributes", "are too long");
    spec.attributes[name] = value;
  }
  return {};
}

}  // namespace

Result<FrameSpec> ReadFrameSpec(const proto::FrameSpec& message) {
  FrameSpec spec;
  spec.width = message.width();
  spec.height = message.height();
  const auto crop = ReadPixelBounds(message.crop());
  if (!crop) return crop.error();
  spec.crop = *crop;
  spec.samples_per_pixel = message.samples_per_pixel();
  spec.tile_size = message.tile_size();
  if (const auto read = ReadChannels(message, spec); !read) return read.error();
  if (const auto read = ReadAttributes(message, spec); !read) return read.error();
  if (message.exr_type() != proto::EXR_TYPE_HALF && message.exr_type() != proto::EXR_TYPE_FLOAT) {
    return BadField("exr_type", "is unknown");
  }
  spec.exr_type = message.exr_type() == proto::EXR_TYPE_FLOAT ? ExrType::kFloat : ExrType::kHalf;
  spec.noise_threshold = message.noise_threshold();
  if (message.denoiser() > static_cast<uint32_t>(kDenoiserLast)) return BadField("denoiser", "is unknown");
  spec.denoiser = static_cast<Denoiser>(message.denoiser());
  if (message.has_cryptomatte_levels()) spec.cryptomatte_levels = message.cryptomatte_levels();
  if (const auto checked = spec.Check(); !checked) return checked.error();
  static_assert(kTileBytesMax == kResultBytesMax);
  if (spec.tile_size > LargestTileSize(spec.Layout().shape())) {
    return BadField("tile_size", "times the number of channels is more than one message may hold");
  }
  // Denoising needs the picture before and after it, and its file.
  const size_t pictures = spec.denoiser == Denoiser::kNone ? 1 : 3;
  const auto values =
      static_cast<int64_t>(spec.Layout().shape().stride() + pictures * spec.PictureChannels().size());
  if (spec.crop.area() * values * static_cast<int64_t>(sizeof(float)) > kFrameBytesMax) {
    return BadInput(
        fmt::format("message refused: a frame of {}x{} pixels with {} values each needs more memory than the "
                    "{} GB that the "
                    "coordinator has for one frame; use fewer channels (--aov), a lower resolution or a crop",
                    spec.crop.width(), spec.crop.height(), values, kFrameBytesMax >> 30));
  }
  return spec;
}

void Write(const FrameSpec& value, proto::FrameSpec& message) {
  message.set_width(value.width);
  message.set_height(value.height);
  Write(value.crop, *message.mutable_crop());
  message.set_samples_per_pixel(value.samples_per_pixel);
  message.set_tile_size(value.tile_size);
  for (const Channel& channel : value.channels) {
    proto::Channel& written = *message.add_channels();
    written.set_name(channel.name);
    written.set_type(static_cast<uint32_t>(channel.type));
    written.set_merge_rule(static_cast<uint32_t>(channel.rule));
    written.set_is_written(channel.is_written);
  }
  message.set_exr_type(value.exr_type == ExrType::kFloat ? proto::EXR_TYPE_FLOAT : proto::EXR_TYPE_HALF);
  message.set_noise_threshold(value.noise_threshold);
  message.set_denoiser(static_cast<uint32_t>(value.denoiser));
  message.set_cryptomatte_levels(value.cryptomatte_levels);
  for (const auto& [name, text] : value.attributes) (*message.mutable_attributes())[name] = text;
}

Result<WorkUnit> ReadWorkUnit(const proto::WorkUnit& message) {
  const auto range = ReadSampleRange(message.range());
  if (!range) return range.error();
  if (message.job() == 0) return BadField("job", "is missing");
  if (message.frame() >= static_cast<uint32_t>(kFramesPerJobMax))
    return BadField("frame", "is beyond the limit");
  const auto scene = ReadDigest(message.scene(), "scene");
  if (!scene) return scene.error();
  return WorkUnit{JobId{message.job()}, message.frame(), message.tile(), *range, *scene};
}

void Write(const WorkUnit& value, proto::WorkUnit& message) {
  message.set_job(Number(value.job));
  message.set_frame(value.frame);
  message.set_tile(value.tile);
  Write(value.range, *message.mutable_range());
  message.set_scene(WriteDigest(value.scene));
}

Result<FarmId> ReadFarmId(const std::string& bytes) {
  if (bytes.empty()) return FarmId{};
  FarmId farm;
  if (bytes.size() != sizeof farm.high + sizeof farm.low) return BadField("farm", "is not 16 bytes");
  for (size_t i = 0; i < bytes.size(); ++i) {
    uint64_t& half = i < sizeof farm.high ? farm.high : farm.low;
    half = half << 8 | static_cast<unsigned char>(bytes[i]);
  }
  return farm;
}

std::string WriteFarmId(FarmId farm) {
  std::string bytes;
  if (farm == FarmId{}) return bytes;
  for (const uint64_t half : {farm.high, farm.low}) {
    for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(half >> shift));
  }
  return bytes;
}

LeaseId ReadLeaseId(const proto::LeaseId& message) {
  return {message.number(), message.session()};
}

void Write(LeaseId value, proto::LeaseId& message) {
  message.set_number(value.number);
  message.set_session(value.session);
}

Result<Lease> ReadLease(const proto::Lease& message) {
  const auto unit = ReadWorkUnit(message.unit());
  if (!unit) return unit.error();
  const auto bounds = ReadPixelBounds(message.bounds());
  if (!bounds) return bounds.error();
  if (bounds->width() > kTileSizeMax || bounds->height() > kTileSizeMax)
    return BadField("bounds", "are too large");
  auto pixels = PixelMask::Read(message.pixels(), static_cast<size_t>(bounds->area()));
  if (!pixels) return BadField("pixels", "are wrong: " + pixels.error().message);
  return Lease{ReadLeaseId(message.lease()), *unit, *bounds, std::move(*pixels),
               std::chrono::milliseconds(message.duration_ms())};
}

void Write(const Lease& value, proto::Lease& message) {
  Write(value.id, *message.mutable_lease());
  Write(value.unit, *message.mutable_unit());
  Write(value.bounds, *message.mutable_bounds());
  message.set_pixels(value.pixels.Bytes());
  message.set_duration_ms(static_cast<uint32_t>(value.duration.count()));
}

Result<SceneRequest> ReadSceneOrder(const proto::SceneRequest& message) {
  const auto key = ReadDigest(message.scene(), "scene");
  if (!key) return key.error();
  const auto package = ReadDigest(message.package(), "package");
  if (!package) return package.error();
  if (!IsPackagePath(message.scene_file())) return BadField("scene_file", "is not a path in a package");
  if (message.options().size() > kOptionsBytesMax) return BadField("options", "are too long");
  auto frame = ReadFrameSpec(message.frame());
  if (!frame) return frame.error();
  SceneRequest order{
      *key, *package, message.scene_file(), message.options(), std::move(*frame), message.needs_all()};
  if (order.key != SceneKey(order.package, order.scene_file, order.options, order.frame))
    return BadField("scene", "is not its key");
  return order;
}

void Write(const SceneRequest& value, proto::SceneRequest& message) {
  message.set_scene(WriteDigest(value.key));
  message.set_package(WriteDigest(value.package));
  message.set_scene_file(value.scene_file);
  message.set_options(value.options);
  Write(value.frame, *message.mutable_frame());
  message.set_needs_all(value.needs_all);
}

}  // namespace tessera
