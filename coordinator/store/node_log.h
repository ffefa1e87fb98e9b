// A record log (record_log.h) of tile nodes: the bytes of the spool's files (file_spool.h), letters "TSRS".
//
// Version 2: a payload is a 32-bit kind, then
//   kind 1, channels: a versioned record (byte_codec.h): the channels that the values of the following nodes
//           have, each its name, type, merge rule and whether it is written (channel.h)
//   kind 2, node: tile, begin and size of its samples, 32 bits each, then its values as floats in the order
//           of ChannelLayout
//   kind 3, scene: the 32 bytes of the SceneKey (terms.h) that the following nodes are rendered from. Nodes
//           before the first of them were written by releases without this kind: they are of the scene that
//           the name of the file tells, if it does (file_spool.h), and count as another scene's if not.
// The meaning of a kind never changes: another form gets another number, and what was written before is still
// read. Version 1 has nodes without kind, and no channels: they are those of the frame. It is read but not
// written: a log of version 1 is never appended to.
//
// Not thread safe.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "coordinator/store/record_log.h"
#include "renderer/film/merger.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

// What the nodes of a log must be rendered from. Nodes of another scene are skipped: their log comes from
// another data directory, or from another history of this one.
struct SceneGuard {
  std::optional<Digest> scene;  // nullopt: any
  // Called once for each log that holds nodes of another scene.
  std::function<void(const std::string& path)> on_foreign;
  // What nodes that name no scene are rendered from; nullopt: unknown.
  std::optional<Digest> bound = std::nullopt;
};

class NodeLog {
 public:
  using Visit = std::function<void(TileNode)>;

  // As RecordLog's. Messages of errors end with what to do.
  static Result<std::unique_ptr<NodeLog>> Create(const std::string& path, const SceneGuard& guard = {});
  // Null if the log is of a version that is not appended to, or holds nodes of another scene. Its torn tail
  // is cut off all the same.
  static Result<std::unique_ptr<NodeLog>> Open(const std::string& path, const Visit& visit,
                                               const SceneGuard& guard = {},
                                               const RecordLog::OnTorn& on_torn = {});
  static Result<void> Read(const std::string& path, RecordLog::Tail tail, const Visit& visit,
                           const SceneGuard& guard = {});

  // Keeps the node in memory until Sync.
  void Append(TileNode node);
  Result<void> Sync() { return log_->Sync(); }
  bool has_pending() const { return log_->has_pending(); }
  void ReleaseFile() { log_->ReleaseFile(); }
  uint64_t synced_bytes() const { return log_->synced_bytes(); }

 private:
  NodeLog(std::unique_ptr<RecordLog> log, std::optional<Digest> scene, SharedChannels channels)
      : log_(std::move(log)), scene_(scene), channels_(std::move(channels)) {}

  std::unique_ptr<RecordLog> log_;
  std::optional<Digest> scene_;  // to be written before the next node
  SharedChannels channels_;      // of the nodes that are appended, as far as the log knows; may be null
};

}  // namespace tessera
