#include "coordinator/store/record_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include "coordinator/core/byte_codec.h"
#include "coordinator/store/crc32c.h"
#include "renderer/util/check.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr size_t kFileHeaderBytes = 8;
constexpr size_t kHeaderBytes = 20;                    // of a record
constexpr uint64_t kFileBytesMax = uint64_t{1} << 36;  // read at once: far above any frame's sums
constexpr size_t kPiecesMax = 512;                     // of one write: below every system's IOV_MAX

std::string FileHeader(const RecordFormat& format) {
  ByteWriter out;
  out.Add32(format.version);
  return std::string(format.letters) + out.Take();
}

std::string RecordHeader(uint32_t length, uint64_t synced, uint32_t payload_crc) {
  ByteWriter out;
  out.Add32(length);
  out.Add64(synced);
  out.Add32(payload_crc);
  std::string bytes = out.Take();
  ByteWriter check;
  check.Add32(Crc32c(bytes));
  return bytes + check.Take();
}

struct Found {
  std::string_view payload;
  uint64_t synced = 0;
};

// The record at the start of `bytes`, or nullopt if it is incomplete or damaged.
std::optional<Found> RecordAt(std::string_view bytes, uint64_t payload_bytes_max) {
  if (bytes.size() < kHeaderBytes) return std::nullopt;
  ByteReader in(bytes);
  const uint32_t length = in.Read32();
  const uint64_t synced = in.Read64();
  const uint32_t payload_crc = in.Read32();
  if (length == 0 || length > payload_bytes_max || length > bytes.size() - kHeaderBytes) return std::nullopt;
  if (in.Read32() != Crc32c(bytes.substr(0, kHeaderBytes - 4))) return std::nullopt;
  const std::string_view payload = bytes.substr(kHeaderBytes, length);
  if (Crc32c(payload) != payload_crc) return std::nullopt;
  return Found{payload, synced};
}

// The position of a readable record after the unreadable bytes at `bad` which shows that those were synced.
std::optional<size_t> WitnessOfDamage(std::string_view bytes, size_t bad, uint64_t payload_bytes_max) {
  for (size_t at = bad + 1; at + kHeaderBytes < bytes.size(); ++at) {
    const auto found = RecordAt(bytes.substr(at), payload_bytes_max);
    if (found && found->synced > bad) return at;
  }
  return std::nullopt;
}

// What is known of a file that was read.
struct LogState {
  uint32_t version = 0;
  uint64_t good_bytes = 0;  // up to the end of the last readable record
  uint64_t torn_bytes = 0;  // after it
};

// The version of a file, or an error if it is of another format or of a version that is not read.
Result<uint32_t> VersionOf(const std::string& path, std::string_view bytes, const RecordFormat& format) {
  if (bytes.size() < kFileHeaderBytes || !bytes.starts_with(format.letters))
    return Failed(fmt::format("{}: is not a file of tessera-coordinator (no \"{}\" at its start)", path,
                              format.letters));
  ByteReader in(bytes.substr(format.letters.size()));
  const uint32_t version = in.Read32();
  if (version < format.oldest_version || version > format.version) {
    return Failed(fmt::format("{}: has version {}; this tessera-coordinator reads versions {} to {}", path,
                              version, format.oldest_version, format.version));
  }
  return version;
}

// Visits the records of a file.
Result<LogState> ReadLog(const std::string& path, const RecordFormat& format, const RecordLog::Visit& visit,
                         std::string_view remedy, RecordLog::Tail tail) {
  const auto bytes = ReadFile(path, kFileBytesMax);
  if (!bytes) return bytes.error();
  const std::string_view all = *bytes;
  const auto version = VersionOf(path, all, format);
  if (!version) return version.error();
  size_t good = kFileHeaderBytes;
  std::vector<std::string_view> payloads;
  while (const auto found = RecordAt(all.substr(good), format.payload_bytes_max)) {
    payloads.push_back(found->payload);
    good += kHeaderBytes + found->payload.size();
  }
  if (const auto witness = WitnessOfDamage(all, good, format.payload_bytes_max)) {
    return Failed(fmt::format("{}: damaged at byte {}, before a readable record at byte {}; {}", path, good,
                              *witness, remedy));
  }
  if (tail == RecordLog::Tail::kWhole && good < all.size())
    return Failed(fmt::format("{}: damaged at byte {}; {}", path, good, remedy));
  for (const std::string_view payload : payloads) {
    const auto visited = visit(payload, *version);
    if (!visited) return Failed(fmt::format("{}: {}; {}", path, visited.error().message, remedy));
  }
  return LogState{*version, good, all.size() - good};
}

std::string_view Bytes(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

void AddPiece(std::vector<iovec>& pieces, std::string_view bytes) {
  if (!bytes.empty()) pieces.push_back({const_cast<char*>(bytes.data()), bytes.size()});
}

// Writes all pieces at `offset`.
bool WriteAt(int file, std::vector<iovec>& pieces, uint64_t offset) {
  for (size_t first = 0; first < pieces.size();) {
    const int count = static_cast<int>(std::min(pieces.size() - first, kPiecesMax));
    const ssize_t result = ::pwritev(file, &pieces[first], count, static_cast<off_t>(offset));
    if (result < 0 && errno == EINTR) continue;
    if (result <= 0) return false;
    auto written = static_cast<size_t>(result);
    offset += written;
    for (; first < pieces.size() && written >= pieces[first].iov_len; ++first)
      written -= pieces[first].iov_len;
    if (written == 0) continue;
    pieces[first].iov_base = static_cast<char*>(pieces[first].iov_base) + written;
    pieces[first].iov_len -= written;
  }
  return true;
}

// Whether a folder holds the file: it was not removed, nor made without a name.
bool HasName(int file) {
  struct stat status {};
  return ::fstat(file, &status) == 0 && status.st_nlink > 0;
}

}  // namespace

RecordLog::RecordLog(std::string path, int file, uint32_t version, uint64_t synced)
    : path_(std::move(path)), file_(file), has_name_(HasName(file)), version_(version), synced_(synced) {}

Result<std::unique_ptr<RecordLog>> RecordLog::Create(const std::string& path, const RecordFormat& format) {
  if (const auto made = WriteFileAtomically(path, FileHeader(format)); !made) return made.error();
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return SystemError(path, "cannot be opened");
  return std::unique_ptr<RecordLog>(new RecordLog(path, file, format.version, kFileHeaderBytes));
}

Result<std::unique_ptr<RecordLog>> RecordLog::Open(const std::string& path, const RecordFormat& format,
                                                   const Visit& visit, std::string_view remedy,
                                                   const OnTorn& on_torn) {
  const auto state = ReadLog(path, format, visit, remedy, Tail::kMayBeTorn);
  if (!state) return state.error();
  if (state->torn_bytes > 0 && on_torn) on_torn(path, state->good_bytes, state->torn_bytes);
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return SystemError(path, "cannot be opened");
  std::unique_ptr<RecordLog> log(new RecordLog(path, file, state->version, state->good_bytes));
  // Truncating frees the reserve, so a file that is whole is left as it is.
  if (state->torn_bytes > 0 && ::ftruncate(file, static_cast<off_t>(state->good_bytes)) != 0)
    return SystemError(path, "cannot be truncated");
  return log;
}

Result<void> RecordLog::Read(const std::string& path, const RecordFormat& format, Tail tail,
                             const Visit& visit, std::string_view remedy) {
  const auto state = ReadLog(path, format, visit, remedy, tail);
  if (!state) return state.error();
  return {};
}

RecordLog::~RecordLog() {
  ReleaseFile();
}

void RecordLog::ReleaseFile() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

void RecordLog::Append(std::string_view head, SharedSums body) {
  const size_t size = head.size() + body->size() * sizeof(float);
  TESSERA_CHECK(size > 0 && size <= UINT32_MAX);
  Record record;
  record.head.reserve(kHeaderBytes + head.size());
  record.head.assign(kHeaderBytes, '\0').append(head);
  record.payload_bytes = static_cast<uint32_t>(size);
  record.payload_crc = Crc32c(Bytes(*body), Crc32c(head));
  record.body = std::move(body);
  pending_bytes_ += kHeaderBytes + size;
  pending_.push_back(std::move(record));
}

Result<void> RecordLog::OpenFile() {
  if (file_ < 0) file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  return file_ < 0 ? Result<void>(SystemError(path_, "cannot be opened")) : Result<void>();
}

void RecordLog::KeepReserve(uint64_t bytes) {
  reserve_ = bytes;
  if (OpenFile()) static_cast<void>(Allocate());  // Sync tries again
}

// Allocates twice the reserve if that is possible, so that few calls have to.
Result<void> RecordLog::Allocate() {
  const uint64_t needed = synced_ + pending_bytes_ + reserve_;
  if (reserve_ == 0 || needed <= allocated_) return {};
  for (const uint64_t end : {needed + reserve_, needed}) {
    const auto begin = static_cast<off_t>(synced_);
    if (::fallocate(file_, FALLOC_FL_KEEP_SIZE, begin, static_cast<off_t>(end) - begin) == 0) {
      allocated_ = end;
      return {};
    }
    if (errno == EOPNOTSUPP || errno == ENOSYS) {
      reserve_ = 0;
      return {};
    }
  }
  return SystemError(path_, "cannot be written");
}

Result<void> RecordLog::Sync(Room room) {
  if (pending_.empty()) return {};
  if (auto opened = OpenFile(); !opened) return opened;
  if (room == Room::kFree) {
    if (auto allocated = Allocate(); !allocated) return allocated;
  }
  std::vector<iovec> pieces;
  pieces.reserve(pending_.size() * 2);
  for (Record& record : pending_) {
    const std::string header = RecordHeader(record.payload_bytes, synced_, record.payload_crc);
    record.head.replace(0, header.size(), header);
    AddPiece(pieces, record.head);
    AddPiece(pieces, Bytes(*record.body));
  }
  // Always from the synced end: what a failed attempt left there is written over.
  if (!WriteAt(file_, pieces, synced_)) return SystemError(path_, "cannot be written");
  if (::fdatasync(file_) != 0) return SystemError(path_, "cannot be synced");
  if (has_name_ && !HasName(file_)) {
    return Failed(
        fmt::format("{}: was removed while it is in use; stop tessera-coordinator, put the data "
                    "directory back and start it again",
                    path_));
  }
  synced_ += pending_bytes_;
  pending_bytes_ = 0;
  pending_.clear();
  return {};
}

}  // namespace tessera
