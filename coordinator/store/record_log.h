// A file of records that is appended to in batches and survives a crash at any moment. Owned by whoever keeps
// something in it (file_journal.h, file_spool.h). Not thread safe.
//
// Bytes, little-endian: a header of 4 letters and a 32-bit version that name the format; then records:
//   32-bit  length of the payload, at least 1
//   64-bit  synced: how many bytes of the file were on stable storage when the record's batch was written
//   32-bit  CRC-32C of the payload
//   32-bit  CRC-32C of the 16 bytes before
//   payload
// A batch that a crash cut short was never acknowledged. The disk may have taken its pages in any order, so
// it may be damaged in the middle as well as cut at its end: all of it from the first unreadable record on is
// taken off. Damage that precedes what a later, readable record calls synced is something else: acknowledged
// records are lost. It is refused.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/film/shared_sums.h"
#include "renderer/util/result.h"

namespace tessera {

struct RecordFormat {
  std::string_view letters;  // 4
  uint32_t version = 0;
  uint64_t payload_bytes_max = 0;
};

class RecordLog {
 public:
  using Visit = std::function<Result<void>(std::string_view payload)>;

  // Makes a log without records in place of what is at the path: whole, or not at all.
  static Result<std::unique_ptr<RecordLog>> Create(const std::string& path, const RecordFormat& format);
  // Hands the payloads to `visit`, in order; then what follows the last of them is cut off. An error if the
  // file is of another format or damaged (it is then left as it is, and `remedy` ends the message), or the
  // first of `visit`.
  static Result<std::unique_ptr<RecordLog>> Open(const std::string& path, const RecordFormat& format,
                                                 const Visit& visit, std::string_view remedy);
  // As Open, for a file that nothing is appended to; it is left as it is. If its tail cannot be torn, a file
  // that is not whole is damaged.
  enum class Tail { kMayBeTorn, kWhole };
  static Result<void> Read(const std::string& path, const RecordFormat& format, Tail tail, const Visit& visit,
                           std::string_view remedy);
  ~RecordLog();
  RecordLog(const RecordLog&) = delete;
  RecordLog& operator=(const RecordLog&) = delete;

  // Keeps a record in memory until Sync. Its payload is `head`, then the bytes of `body`.
  void Append(std::string_view head, SharedSums body = {});
  // All records appended so far are on stable storage when this succeeds. When it fails they stay in memory
  // and it may be tried again.
  Result<void> Sync();
  bool has_pending() const { return !pending_.empty(); }
  uint64_t synced_bytes() const { return synced_; }
  uint64_t pending_bytes() const { return pending_bytes_; }

 private:
  struct Record {
    std::string head;  // with room for the record's header before it
    SharedSums body;
    uint32_t payload_bytes = 0, payload_crc = 0;
  };
  RecordLog(std::string path, int file, uint64_t synced)
      : path_(std::move(path)), file_(file), synced_(synced) {}

  std::string path_;
  int file_;
  uint64_t synced_;  // bytes of the file on stable storage
  std::vector<Record> pending_;
  uint64_t pending_bytes_ = 0;
};

}  // namespace tessera
