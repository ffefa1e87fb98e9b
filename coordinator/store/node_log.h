// A record log (record_log.h) of tile nodes: the bytes of the spool's files (file_spool.h), letters "TSRS".
//
// Version 2: a payload is a 32-bit kind, then
//   kind 1, channels: a versioned record (byte_codec.h): the channels that the values of the following nodes
//           have, each its name, type, merge rule and whether it is written (channel.h)
//   kind 2, node: tile, begin and size of its samples, 32 bits each, then its values as floats in the order
//           of ChannelLayout
// The meaning of a kind never changes: another form gets another number, and what was written before is still
// read. Version 1 has nodes without kind, and no channels: they are those of the frame. It is read but not
// written: a log of version 1 is never appended to.
//
// Not thread safe.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "coordinator/store/record_log.h"
#include "renderer/film/merger.h"
#include "renderer/util/result.h"

namespace tessera {

class NodeLog {
 public:
  using Visit = std::function<void(TileNode)>;

  // As RecordLog's. Messages of errors end with what to do.
  static Result<std::unique_ptr<NodeLog>> Create(const std::string& path);
  // Null if the log is of a version that is not appended to; its torn tail is cut off all the same.
  static Result<std::unique_ptr<NodeLog>> Open(const std::string& path, const Visit& visit,
                                               const RecordLog::OnTorn& on_torn = {});
  static Result<void> Read(const std::string& path, RecordLog::Tail tail, const Visit& visit);

  // Keeps the node in memory until Sync.
  void Append(TileNode node);
  Result<void> Sync() { return log_->Sync(); }
  bool has_pending() const { return log_->has_pending(); }
  void ReleaseFile() { log_->ReleaseFile(); }
  uint64_t synced_bytes() const { return log_->synced_bytes(); }

 private:
  NodeLog(std::unique_ptr<RecordLog> log, SharedChannels channels)
      : log_(std::move(log)), channels_(std::move(channels)) {}

  std::unique_ptr<RecordLog> log_;
  SharedChannels channels_;  // of the nodes that are appended, as far as the log knows; may be null
};

}  // namespace tessera
