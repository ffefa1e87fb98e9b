#include "coordinator/store/node_log.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "coordinator/core/byte_codec.h"
#include "coordinator/core/job_codec.h"
#include "proto/terms.h"

namespace tessera {
namespace {

enum class Kind : uint32_t { kChannels = 1, kNode = 2, kScene = 3 };

constexpr uint32_t kSpoolVersion = 2;
constexpr uint32_t kSpoolVersionWithoutKinds = 1;
constexpr uint32_t kChannelsVersion = 1;
constexpr size_t kHeadBytesMax = 16;  // of a node: its kind, its tile and its samples
constexpr RecordFormat kSpoolFormat{"TSRS", kSpoolVersion, kSpoolVersionWithoutKinds,
                                    static_cast<uint64_t>(kResultBytesMax) + kHeadBytesMax};
constexpr const char* kSpoolRemedy =
    "move the file away to continue without its results, which are then rendered again";

Result<TileNode> DecodeNode(std::string_view payload) {
  constexpr size_t kHeadBytes = 12;
  const size_t value_bytes = payload.size() - std::min(payload.size(), kHeadBytes);
  ByteReader in(payload.substr(0, kHeadBytes));
  TileNode node;
  node.tile = in.Read32();
  node.range.begin = in.Read32();
  node.range.size = in.Read32();
  if (!in.ok() || !node.range.IsDyadic() || value_bytes == 0 || value_bytes % sizeof(float) != 0)
    return Failed("does not contain sums of samples");
  std::vector<float> values(value_bytes / sizeof(float));
  std::memcpy(values.data(), payload.data() + kHeadBytes, value_bytes);
  node.sums = std::move(values);
  return node;
}

// Reads the payloads of a log one after the other.
class NodeReader {
 public:
  NodeReader(const NodeLog::Visit& visit, const SceneGuard& guard)
      : visit_(visit), guard_(guard), is_foreign_(guard.scene && guard.bound != guard.scene) {}

  Result<void> Read(std::string_view payload, uint32_t version) {
    if (version == kSpoolVersionWithoutKinds) return ReadNode(payload);
    ByteReader in(payload);
    const auto kind = static_cast<Kind>(in.Read32());
    if (kind == Kind::kChannels) return ReadChannelList(in);
    if (kind == Kind::kScene) return ReadScene(payload.substr(sizeof(uint32_t)));
    if (kind == Kind::kNode) return ReadNode(payload.substr(sizeof(uint32_t)));
    return Failed("contains a record of an unknown kind: it may be from a newer version");
  }
  const SharedChannels& channels() const { return channels_; }
  bool has_scene() const { return has_scene_; }
  bool has_foreign() const { return has_foreign_; }

 private:
  Result<void> ReadChannelList(ByteReader& in) {
    auto record = in.ReadRecord(kChannelsVersion);
    std::vector<Channel> channels;
    if (!record || !ReadChannels(record->body, channels) || !record->IsReadBy(kChannelsVersion) ||
        !in.at_end()) {
      return Failed("contains a list of channels that cannot be read");
    }
    channels_ = std::make_shared<const std::vector<Channel>>(std::move(channels));
    return {};
  }
  Result<void> ReadScene(std::string_view bytes) {
    Digest scene;
    if (bytes.size() != scene.bytes.size()) return Failed("contains a scene digest that cannot be read");
    std::memcpy(scene.bytes.data(), bytes.data(), bytes.size());
    has_scene_ = true;
    is_foreign_ = guard_.scene && scene != *guard_.scene;
    has_foreign_ |= is_foreign_;
    return {};
  }
  Result<void> ReadNode(std::string_view bytes) {
    has_foreign_ |= is_foreign_;
    if (is_foreign_) return {};
    auto node = DecodeNode(bytes);
    if (!node) return node.error();
    node->channels = channels_;
    visit_(std::move(*node));
    return {};
  }

  const NodeLog::Visit& visit_;
  const SceneGuard& guard_;
  SharedChannels channels_;
  bool has_scene_ = false;    // some nodes name their scene
  bool is_foreign_;           // what follows is not of the scene of the guard
  bool has_foreign_ = false;  // nor was something before it
};

void Report(const NodeReader& reader, const SceneGuard& guard, const std::string& path) {
  if (reader.has_foreign() && guard.on_foreign) guard.on_foreign(path);
}

RecordLog::Visit VisitorOf(NodeReader& reader) {
  return [&reader](std::string_view payload, uint32_t version) { return reader.Read(payload, version); };
}

}  // namespace

Result<std::unique_ptr<NodeLog>> NodeLog::Create(const std::string& path, const SceneGuard& guard) {
  auto log = RecordLog::Create(path, kSpoolFormat);
  if (!log) return log.error();
  return std::unique_ptr<NodeLog>(new NodeLog(std::move(*log), guard.scene, nullptr));
}

Result<std::unique_ptr<NodeLog>> NodeLog::Open(const std::string& path, const Visit& visit,
                                               const SceneGuard& guard, const RecordLog::OnTorn& on_torn) {
  NodeReader reader(visit, guard);
  auto log = RecordLog::Open(path, kSpoolFormat, VisitorOf(reader), kSpoolRemedy, on_torn);
  if (!log) return log.error();
  Report(reader, guard, path);
  if ((*log)->version() != kSpoolVersion || reader.has_foreign()) return std::unique_ptr<NodeLog>();
  return std::unique_ptr<NodeLog>(
      new NodeLog(std::move(*log), reader.has_scene() ? std::nullopt : guard.scene, reader.channels()));
}

Result<void> NodeLog::Read(const std::string& path, RecordLog::Tail tail, const Visit& visit,
                           const SceneGuard& guard) {
  NodeReader reader(visit, guard);
  auto read = RecordLog::Read(path, kSpoolFormat, tail, VisitorOf(reader), kSpoolRemedy);
  Report(reader, guard, path);
  return read;
}

void NodeLog::Append(TileNode node) {
  if (const auto scene = std::exchange(scene_, std::nullopt)) {
    ByteWriter record;
    record.Add32(static_cast<uint32_t>(Kind::kScene));
    log_->Append(record.Take() + std::string(scene->bytes.begin(), scene->bytes.end()));
  }
  const bool is_named = node.channels != nullptr;
  if (is_named && node.channels != channels_ && (channels_ == nullptr || *node.channels != *channels_)) {
    ByteWriter list, record;
    AddChannels(list, *node.channels);
    record.Add32(static_cast<uint32_t>(Kind::kChannels));
    record.AddRecord(kChannelsVersion, kChannelsVersion, list.Take());
    log_->Append(record.Take());
  }
  if (is_named) channels_ = node.channels;
  ByteWriter head;
  head.Add32(static_cast<uint32_t>(Kind::kNode));
  head.Add32(node.tile);
  head.Add32(node.range.begin);
  head.Add32(node.range.size);
  log_->Append(head.Take(), std::move(node.sums));
}

}  // namespace tessera
