#include "store/file_journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "core/byte_codec.h"
#include "util/file.h"

namespace tessera {
namespace {

constexpr std::string_view kMagic = "TSRJ";
constexpr uint32_t kVersion = 1;
constexpr size_t kHeaderBytes = 8;
constexpr size_t kRecordHeaderBytes = 8;
constexpr uint64_t kJournalBytesMax = uint64_t{4} << 30;

std::string Header() {
  ByteWriter out;
  out.Add32(kVersion);
  return std::string(kMagic) + out.Take();
}

uint32_t Crc(uint32_t length, std::string_view payload) {
  ByteWriter out;
  out.Add32(length);
  const std::string prefix = out.Take();
  uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(prefix.data()), prefix.size());
  return static_cast<uint32_t>(crc32_z(crc, reinterpret_cast<const Bytef*>(payload.data()), payload.size()));
}

// The payload of the whole and undamaged record at the begin of `bytes`.
std::optional<std::string_view> RecordAt(std::string_view bytes) {
  if (bytes.size() < kRecordHeaderBytes) return std::nullopt;
  ByteReader in(bytes);
  const uint32_t length = in.Read32();
  const uint32_t crc = in.Read32();
  if (length == 0 || length > kFactBytesMax || length > bytes.size() - kRecordHeaderBytes)
    return std::nullopt;
  const std::string_view payload = bytes.substr(kRecordHeaderBytes, length);
  if (Crc(length, payload) != crc) return std::nullopt;
  return payload;
}

Error SystemError(const std::string& path, const char* what) {
  return Failed(fmt::format("{}: {}: {}", path, what, std::strerror(errno)));
}

// A new journal, complete at its name or not there at all.
Result<void> MakeJournal(const std::string& path) {
  if (std::filesystem::exists(path)) return {};
  return WriteFileAtomically(path, Header());
}

}  // namespace

std::string EncodeRecord(std::string_view payload) {
  TESSERA_CHECK(!payload.empty() && payload.size() <= kFactBytesMax);
  const auto length = static_cast<uint32_t>(payload.size());
  ByteWriter out;
  out.Add32(length);
  out.Add32(Crc(length, payload));
  return out.Take() + std::string(payload);
}

Result<Records> ReadRecords(std::string_view bytes) {
  Records records;
  while (const auto payload = RecordAt(bytes.substr(records.bytes))) {
    records.payloads.push_back(*payload);
    records.bytes += kRecordHeaderBytes + payload->size();
  }
  for (size_t at = records.bytes + 1; at < bytes.size(); ++at) {
    if (RecordAt(bytes.substr(at))) {
      return Failed(fmt::format("damaged at byte {}, before a readable record at byte {}",
                                records.bytes + kHeaderBytes, at + kHeaderBytes));
    }
  }
  return records;
}

Result<std::unique_ptr<FileJournal>> FileJournal::Open(const std::string& path,
                                                       const std::function<void(const Fact&)>& restore) {
  if (const auto made = MakeJournal(path); !made) return made.error();
  const auto bytes = ReadFile(path, kJournalBytesMax);
  if (!bytes) return bytes.error();
  if (!bytes->starts_with(Header()))
    return Failed(path + ": is not a journal of this version of tessera-coordinator");
  const auto records = ReadRecords(std::string_view(*bytes).substr(kHeaderBytes));
  if (!records) {
    return Failed(
        fmt::format("{}: {}; to go on with what precedes the damage, truncate the file there; to go on "
                    "without any job, move it away",
                    path, records.error().message));
  }
  for (const std::string_view payload : records->payloads) {
    const auto fact = DecodeFact(payload);
    if (!fact) return Failed(fmt::format("{}: {}", path, fact.error().message));
    restore(*fact);
  }
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return SystemError(path, "cannot be opened");
  const uint64_t size = kHeaderBytes + records->bytes;
  std::unique_ptr<FileJournal> journal(new FileJournal(path, file, size));
  if (::ftruncate(file, static_cast<off_t>(size)) != 0) return SystemError(path, "cannot be truncated");
  return journal;
}

FileJournal::~FileJournal() {
  ::close(file_);
}

void FileJournal::Append(const Fact& fact) {
  pending_ += EncodeRecord(EncodeFact(fact));
}

Result<void> FileJournal::Sync() {
  if (pending_.empty()) return {};
  // Always from the synced end: what a failed attempt left there is written over.
  size_t written = 0;
  while (written < pending_.size()) {
    const ssize_t count = ::pwrite(file_, pending_.data() + written, pending_.size() - written,
                                   static_cast<off_t>(size_ + written));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return SystemError(path_, "cannot be written");
    written += static_cast<size_t>(count);
  }
  if (::fdatasync(file_) != 0) return SystemError(path_, "cannot be synced");
  size_ += pending_.size();
  pending_.clear();
  return {};
}

}  // namespace tessera
