#include "coordinator/core/job_codec.h"

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

namespace tessera {
namespace {

constexpr uint32_t kVersion = 1;  // of FrameRequest
constexpr uint32_t kFrameSpecVersion = 3;
constexpr uint32_t kJobVersion = 2, kJobReadableBy = 1;

// Releases that do not know of a member make the same pictures of frames that have its default.
uint32_t ReadableBy(const FrameSpec& spec) {
  if (spec.cryptomatte_levels != kCryptomatteLevelsDefault) return 3;
  return spec.denoiser == Denoiser::kNone ? 1 : 2;
}

void AddFrameSpec(ByteWriter& out, const FrameSpec& spec) {
  ByteWriter body;
  for (const int value : {spec.width, spec.height, spec.crop.x0, spec.crop.y0, spec.crop.x1, spec.crop.y1}) {
    body.Add32(static_cast<uint32_t>(value));
  }
  body.Add32(spec.samples_per_pixel);
  body.Add32(static_cast<uint32_t>(spec.tile_size));
  body.Add32(static_cast<uint32_t>(spec.exr_type));
  AddChannels(body, spec.channels);
  body.Add64(spec.attributes.size());
  for (const auto& [name, value] : spec.attributes) {
    body.AddText(name);
    body.AddText(value);
  }
  body.Add64(std::bit_cast<uint64_t>(spec.noise_threshold));
  body.Add32(static_cast<uint32_t>(spec.denoiser));
  body.Add32(spec.cryptomatte_levels);
  out.AddRecord(kFrameSpecVersion, ReadableBy(spec), body.Take());
}

bool ReadSizes(ByteReader& in, FrameSpec& spec) {
  for (int* value : {&spec.width, &spec.height, &spec.crop.x0, &spec.crop.y0, &spec.crop.x1, &spec.crop.y1}) {
    *value = static_cast<int>(in.Read32());
  }
  spec.samples_per_pixel = in.Read32();
  spec.tile_size = static_cast<int>(in.Read32());
  const uint32_t exr_type = in.Read32();
  if (exr_type > static_cast<uint32_t>(ExrType::kFloat)) return false;
  spec.exr_type = static_cast<ExrType>(exr_type);
  return true;
}

bool ReadChannel(ByteReader& in, Channel& channel) {
  channel.name = in.ReadText();
  const uint32_t type = in.Read32(), rule = in.Read32(), written = in.Read32();
  channel.type = static_cast<ChannelType>(type);
  channel.rule = static_cast<MergeRule>(rule);
  channel.is_written = written == 1;
  return type <= static_cast<uint32_t>(kChannelTypeLast) &&
         rule <= static_cast<uint32_t>(MergeRule::kIdWeights) && written <= 1;
}

void ReadAttributes(ByteReader& in, FrameSpec& spec) {
  for (uint64_t n = in.ReadCount(16); n > 0; --n) {
    std::string name = in.ReadText();
    spec.attributes[std::move(name)] = in.ReadText();
  }
}

bool ReadDenoiser(ByteReader& in, FrameSpec& spec) {
  const uint32_t denoiser = in.Read32();
  spec.denoiser = static_cast<Denoiser>(denoiser);
  return denoiser <= static_cast<uint32_t>(kDenoiserLast);
}

bool ReadFrameSpec(ByteReader& in, FrameSpec& spec) {
  auto record = in.ReadRecord(kFrameSpecVersion);
  if (!record || !ReadSizes(record->body, spec)) return false;
  if (!ReadChannels(record->body, spec.channels)) return false;
  ReadAttributes(record->body, spec);
  spec.noise_threshold = std::bit_cast<double>(record->body.Read64());
  if (record->version >= 2 && !ReadDenoiser(record->body, spec)) return false;
  if (record->version >= 3) spec.cryptomatte_levels = record->body.Read32();
  return record->IsReadBy(kFrameSpecVersion) && spec.Check().has_value();
}

bool ReadFrameSpecByNames(ByteReader& in, FrameSpec& spec) {
  if (!ReadSizes(in, spec)) return false;
  std::vector<std::string> names;
  for (uint64_t n = in.ReadCount(8); n > 0; --n) names.push_back(in.ReadText());
  ReadAttributes(in, spec);
  spec.noise_threshold = std::bit_cast<double>(in.Read64());
  const uint32_t writes_samples = in.Read32();
  spec.channels = ChannelsFromNames(names, writes_samples == 1);
  return writes_samples <= 1 && in.ok() && spec.Check().has_value();
}

void AddFrameRequest(ByteWriter& out, const FrameRequest& frame) {
  ByteWriter body;
  body.AddText(frame.scene_file);
  body.AddText(frame.options);
  body.Add32(static_cast<uint32_t>(frame.number));
  body.Add32(frame.extendable ? 1 : 0);
  AddFrameSpec(body, frame.spec);
  out.AddRecord(kVersion, kVersion, body.Take());
}

// What both forms begin with.
void ReadFrameHead(ByteReader& in, FrameRequest& frame) {
  frame.scene_file = in.ReadText();
  frame.options = in.ReadText();
  frame.number = static_cast<int32_t>(in.Read32());
  frame.extendable = in.Read32() != 0;
}

bool ReadFrameRequest(ByteReader& in, FrameRequest& frame) {
  auto record = in.ReadRecord(kVersion);
  if (!record) return false;
  ReadFrameHead(record->body, frame);
  return ReadFrameSpec(record->body, frame.spec) && record->IsReadBy(kVersion);
}

bool ReadFrameRequestByNames(ByteReader& in, FrameRequest& frame) {
  ReadFrameHead(in, frame);
  return ReadFrameSpecByNames(in, frame.spec);
}

// The members of a job, whose frames `read_frame` reads.
template <typename ReadFrame>
bool ReadMembers(ByteReader& in, JobSpec& spec, ReadFrame read_frame) {
  spec.submission = in.Read64();
  spec.name = in.ReadText();
  spec.priority = static_cast<int32_t>(in.Read32());
  if (!ReadDigest(in, spec.package)) return false;
  for (uint64_t n = in.ReadCount(16); n > 0; --n) {
    if (!read_frame(in, spec.frames.emplace_back())) return false;
  }
  for (uint64_t n = in.ReadCount(8); n > 0; --n) {
    const std::string tag = in.ReadText();
    if (!IsTag(tag) || spec.required_tags.size() >= kTagsMax) return false;
    spec.required_tags.insert(tag);
  }
  spec.verify_share = std::bit_cast<double>(in.Read64());
  return in.ok() && IsShare(spec.verify_share) && !spec.frames.empty() &&
         spec.frames.size() <= static_cast<size_t>(kFramesPerJobMax);
}

// What version 2 of a job adds.
bool ReadFirst(ByteReader& in, JobSpec& spec) {
  const uint32_t has_first = in.Read32();
  Region first;
  for (float* side : {&first.x0, &first.x1, &first.y0, &first.y1}) *side = std::bit_cast<float>(in.Read32());
  if (has_first == 1) spec.first = first;
  return in.ok() && has_first <= 1 && IsRegion(first);
}

}  // namespace

void AddDigest(ByteWriter& out, const Digest& digest) {
  out.AddText({reinterpret_cast<const char*>(digest.bytes.data()), digest.bytes.size()});
}

bool ReadDigest(ByteReader& in, Digest& digest) {
  const std::string bytes = in.ReadText();
  if (bytes.size() != digest.bytes.size()) return false;
  std::copy(bytes.begin(), bytes.end(), digest.bytes.begin());
  return true;
}

void AddChannels(ByteWriter& out, const std::vector<Channel>& channels) {
  out.Add64(channels.size());
  for (const Channel& channel : channels) {
    out.AddText(channel.name);
    out.Add32(static_cast<uint32_t>(channel.type));
    out.Add32(static_cast<uint32_t>(channel.rule));
    out.Add32(channel.is_written ? 1 : 0);
  }
}

bool ReadChannels(ByteReader& in, std::vector<Channel>& channels) {
  channels.clear();
  for (uint64_t n = in.ReadCount(20); n > 0; --n) {
    if (!ReadChannel(in, channels.emplace_back())) return false;
  }
  return in.ok();
}

void AddJobSpec(ByteWriter& out, const JobSpec& spec) {
  ByteWriter body;
  body.Add64(spec.submission);
  body.AddText(spec.name);
  body.Add32(static_cast<uint32_t>(spec.priority));
  AddDigest(body, spec.package);
  body.Add64(spec.frames.size());
  for (const FrameRequest& frame : spec.frames) AddFrameRequest(body, frame);
  body.Add64(spec.required_tags.size());
  for (const std::string& tag : spec.required_tags) body.AddText(tag);
  body.Add64(std::bit_cast<uint64_t>(spec.verify_share));
  body.Add32(spec.first ? 1 : 0);
  const Region first = spec.first.value_or(Region{});
  for (const float side : {first.x0, first.x1, first.y0, first.y1}) body.Add32(std::bit_cast<uint32_t>(side));
  out.AddRecord(kJobVersion, kJobReadableBy, body.Take());
}

bool ReadJobSpec(ByteReader& in, JobSpec& spec) {
  auto record = in.ReadRecord(kJobVersion);
  if (!record || !ReadMembers(record->body, spec, ReadFrameRequest)) return false;
  if (record->version > 1 && !ReadFirst(record->body, spec)) return false;
  return record->IsReadBy(kJobVersion);
}

void AddJobOrder(ByteWriter& out, const JobOrder& order) {
  const SceneOrder& scene = order.scene;
  const FrameRange range = scene.frames.value_or(FrameRange{});
  ByteWriter body;
  body.Add64(order.submission);
  body.AddText(order.name);
  body.Add32(static_cast<uint32_t>(order.priority));
  AddDigest(body, scene.package);
  body.AddText(scene.scene_file);
  body.AddText(scene.options);
  body.Add32(scene.frames ? 1 : 0);
  for (const int value : {range.first, range.last, range.step}) body.Add32(static_cast<uint32_t>(value));
  body.Add64(std::bit_cast<uint64_t>(scene.frames_per_second));
  out.AddRecord(kVersion, kVersion, body.Take());
}

bool ReadJobOrder(ByteReader& in, JobOrder& order) {
  auto record = in.ReadRecord(kVersion);
  if (!record) return false;
  ByteReader& body = record->body;
  SceneOrder& scene = order.scene;
  order.submission = body.Read64();
  order.name = body.ReadText();
  order.priority = static_cast<int32_t>(body.Read32());
  if (!ReadDigest(body, scene.package)) return false;
  scene.scene_file = body.ReadText();
  scene.options = body.ReadText();
  const uint32_t is_sequence = body.Read32();
  FrameRange range;
  for (int* value : {&range.first, &range.last, &range.step}) *value = static_cast<int>(body.Read32());
  if (is_sequence == 1) scene.frames = range;
  scene.frames_per_second = std::bit_cast<double>(body.Read64());
  return is_sequence <= 1 && record->IsReadBy(kVersion) && order.priority >= -kPriorityMax &&
         order.priority <= kPriorityMax && CheckSceneOrder(scene);
}

bool ReadJobSpecByNames(ByteReader& in, JobSpec& spec) {
  return ReadMembers(in, spec, ReadFrameRequestByNames);
}

}  // namespace tessera
