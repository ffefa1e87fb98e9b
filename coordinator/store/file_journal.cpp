#include "coordinator/store/file_journal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "renderer/util/check.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr RecordFormat kJournalFormat{"TSRJ", 2, 2, kFactBytesMax};
constexpr const char* kJournalRemedy =
    "to keep the records before the damage, truncate the file there; to start without any jobs, move it away "
    "and "
    "use --start-afresh";

}  // namespace

Result<std::unique_ptr<FileJournal>> FileJournal::Open(const std::string& path,
                                                       const std::function<void(const Fact&)>& restore,
                                                       const RecordLog::OnTorn& on_torn) {
  const auto visit = [&](std::string_view payload, uint32_t) -> Result<void> {
    const auto fact = DecodeFact(payload);
    if (!fact) return fact.error();
    restore(*fact);
    return {};
  };
  auto log = std::filesystem::exists(path)
                 ? RecordLog::Open(path, kJournalFormat, visit, kJournalRemedy, on_torn)
                 : RecordLog::Create(path, kJournalFormat);
  if (!log) return log.error();
  (*log)->KeepReserve(kJournalReserveBytes);
  return std::unique_ptr<FileJournal>(new FileJournal(path, std::move(*log)));
}

void FileJournal::Append(const Fact& fact) {
  log_->Append(EncodeFact(fact));
}

Result<void> FileJournal::Sync(Room room) {
  if (auto synced = SyncName(); !synced) return synced;
  return log_->Sync(room);
}

// Until the name of a new file is on stable storage, a crash may bring back the old one, without what was
// appended since.
Result<void> FileJournal::SyncName() {
  if (is_name_synced_) return {};
  auto synced = SyncFolder(std::filesystem::path(path_).parent_path().string());
  is_name_synced_ = synced.has_value();
  return synced;
}

bool FileJournal::IsLarge() const {
  return log_->synced_bytes() > std::max(kJournalBytesMin, 2 * counting_bytes_);
}

Result<void> FileJournal::Replace(const std::vector<Fact>& facts) {
  TESSERA_CHECK(!log_->has_pending());
  const std::string beside = path_ + ".new";
  auto log = RecordLog::Create(beside, kJournalFormat);
  if (!log) return log.error();
  (*log)->KeepReserve(kJournalReserveBytes);
  for (const Fact& fact : facts) (*log)->Append(EncodeFact(fact));
  auto replaced = (*log)->Sync();
  if (replaced && std::rename(beside.c_str(), path_.c_str()) != 0) {
    replaced = Failed(fmt::format("{}: cannot be replaced: {}", path_, std::strerror(errno)));
  }
  if (!replaced) {
    std::remove(beside.c_str());
    return replaced;
  }
  log_ = std::move(*log);
  counting_bytes_ = log_->synced_bytes();
  is_name_synced_ = false;
  return SyncName();
}

}  // namespace tessera
