// A file of records that is appended to in batches and survives a crash at any moment. Used by the journal
// (file_journal.h) and the spool (node_log.h). Not thread safe.
//
// Bytes, little-endian: a header of 4 letters and a 32-bit version that name the format of the payloads; then
// records, whose form is the same in all versions so far:
//   32-bit  length of the payload, at least 1
//   64-bit  synced: number of bytes of the file on stable storage when the record's batch was written
//   32-bit  CRC-32C of the payload
//   32-bit  CRC-32C of the 16 bytes before
//   payload
// A batch that a crash cut short was never acknowledged. The disk may have written its pages in any order, so
// it may be damaged in the middle as well as truncated: everything from the first unreadable record on is cut
// off. Damage before the synced size of a later, readable record means that acknowledged records are lost,
// and the file is refused.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/core/journal.h"
#include "renderer/film/shared_sums.h"
#include "renderer/util/result.h"

namespace tessera {

struct RecordFormat {
  std::string_view letters;     // 4
  uint32_t version = 0;         // that is written
  uint32_t oldest_version = 0;  // that is read
  uint64_t payload_bytes_max = 0;
};

class RecordLog {
 public:
  using Visit = std::function<Result<void>(std::string_view payload, uint32_t version)>;
  // Receives where bytes without a readable record began that were cut off, and how many they were.
  using OnTorn = std::function<void(const std::string& path, uint64_t offset, uint64_t bytes)>;

  // Creates a log without records and atomically replaces what is at the path.
  static Result<std::unique_ptr<RecordLog>> Create(const std::string& path, const RecordFormat& format);
  // Calls `visit` with the payloads in order and cuts off what follows the last of them. An error if the file
  // has another format or is damaged: the file is then left as it is, and the message ends with `remedy`. The
  // first error of `visit` is returned as well.
  static Result<std::unique_ptr<RecordLog>> Open(const std::string& path, const RecordFormat& format,
                                                 const Visit& visit, std::string_view remedy,
                                                 const OnTorn& on_torn = {});
  // The same without opening the file for appending; the file is not changed. With kWhole a file that ends in
  // the middle of a record is damaged.
  enum class Tail { kMayBeTorn, kWhole };
  static Result<void> Read(const std::string& path, const RecordFormat& format, Tail tail, const Visit& visit,
                           std::string_view remedy);
  ~RecordLog();
  RecordLog(const RecordLog&) = delete;
  RecordLog& operator=(const RecordLog&) = delete;

  // Keeps a record in memory until Sync. Its payload is `head`, then the bytes of `body`.
  void Append(std::string_view head, SharedSums body = {});
  // From now on, keeps this much of the disk beyond the end of the file, of which only Sync with kReserve
  // takes. The blocks belong to the file and not to its size, so no other file gets them, a crash leaves them
  // there, and a reader does not see them. Does nothing on file systems that cannot do it.
  void KeepReserve(uint64_t bytes);
  // If this succeeds, all records appended so far are on stable storage. If it fails, they stay in memory and
  // it may be called again. A file that somebody has removed is a failure, and so is a disk that has no room
  // for the reserve after the records, unless they may use it.
  Result<void> Sync(Room room = Room::kFree);
  bool has_pending() const { return !pending_.empty(); }
  // Closes the file until the next Sync that has something to write.
  void ReleaseFile();
  uint64_t synced_bytes() const { return synced_; }
  // Of the file: an older one keeps its version, and takes only records of that version.
  uint32_t version() const { return version_; }

 private:
  struct Record {
    std::string head;  // with room for the record's header before it
    SharedSums body;
    uint32_t payload_bytes = 0, payload_crc = 0;
  };
  RecordLog(std::string path, int file, uint32_t version, uint64_t synced);
  Result<void> OpenFile();
  Result<void> Allocate();

  std::string path_;
  int file_;             // -1: released
  const bool has_name_;  // when it was opened
  uint32_t version_;
  uint64_t synced_;  // bytes of the file on stable storage
  std::vector<Record> pending_;
  uint64_t pending_bytes_ = 0;
  uint64_t reserve_ = 0;
  uint64_t allocated_ = 0;  // the disk has room for at least this much of the file
};

}  // namespace tessera
