// The file in which messages of jobs (job_log.h) survive a restart: a record log (record_log.h) with the
// letters "TSJL". A payload is a versioned record (byte_codec.h): number of the job and of its submission,
// number and time of the entry, 64 bits each, its level, 32 bits, and its text. Nothing depends on it: a file
// that is damaged or missing is begun anew, and what a full disk refuses is left out. Not thread safe.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "coordinator/store/record_log.h"
#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

struct StoredMessage {
  JobId job{};
  uint64_t submission = 0;
  JobLogEntry entry;
};

std::string EncodeMessage(const StoredMessage& message);
// An error for anything that EncodeMessage does not write.
Result<StoredMessage> DecodeMessage(std::string_view bytes);

class MessageFile {
 public:
  // Visits what the file holds. The error says why it cannot be read; it is left as it is then.
  static Result<MessageFile> Open(const std::string& path, const std::function<void(StoredMessage)>& visit);
  // An empty file in the place of what is at the path.
  static Result<MessageFile> Create(const std::string& path);

  // Keeps the message in memory until Sync.
  void Append(const StoredMessage& message);
  Result<void> Sync() { return log_->Sync(); }
  // Whether messages could not be written yet.
  bool has_pending() const { return log_->has_pending(); }
  uint64_t bytes() const { return log_->synced_bytes(); }

 private:
  explicit MessageFile(std::unique_ptr<RecordLog> log) : log_(std::move(log)) {}
  std::unique_ptr<RecordLog> log_;
};

}  // namespace tessera
