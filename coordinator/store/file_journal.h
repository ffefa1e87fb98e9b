// The journal as a file. Bytes: "TSRJ", 32-bit version 1; then records: 32-bit length of the payload, 32-bit
// CRC (zlib's) of length and payload, payload (EncodeFact). Little-endian. A record that a crash cut short at
// the end was never acknowledged: it is taken off. Damage before a readable record is refused: facts that
// were acknowledged would be lost silently. One thread at a time. Owned by the coordinator's core thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/journal.h"
#include "util/result.h"

namespace tessera {

constexpr size_t kFactBytesMax = size_t{64} << 20;  // above any message, so above any job

class FileJournal : public Journal {
 public:
  // Opens or makes the file; hands the facts in it, in order, to `restore`.
  static Result<std::unique_ptr<FileJournal>> Open(const std::string& path,
                                                   const std::function<void(const Fact&)>& restore);
  ~FileJournal() override;
  FileJournal(const FileJournal&) = delete;
  FileJournal& operator=(const FileJournal&) = delete;

  void Append(const Fact& fact) override;
  Result<void> Sync() override;

 private:
  FileJournal(std::string path, int file, uint64_t size) : path_(std::move(path)), file_(file), size_(size) {}
  std::string path_;
  int file_;
  uint64_t size_;        // bytes of the file that are synced
  std::string pending_;  // records not written yet
};

// The record of a payload, as it is in the file.
std::string EncodeRecord(std::string_view payload);
// The payloads of a file's records (without its header) and how many bytes they take; what follows is a torn
// tail. An error if a readable record follows damage.
struct Records {
  std::vector<std::string_view> payloads;
  size_t bytes = 0;
};
Result<Records> ReadRecords(std::string_view bytes);

}  // namespace tessera
