// The journal as a file: a record log (record_log.h) "TSRJ", version 2, whose payloads are those of
// EncodeFact. Facts have versions of their own (fact.h), so a new form of a fact leaves this version as it
// is. A record that a crash cut short was never acknowledged and is cut off. Damage to acknowledged facts is
// refused, as they would be lost silently. The file is replaced by the facts that still matter when it is
// twice as large as it was after the last time, and at least kJournalBytesMin. So it stays below
//   max(kJournalBytesMin, 2 x size of the facts that matter) + one batch.
// One to two times kJournalReserveBytes of the disk are kept beside that (RecordLog::KeepReserve).
// Not thread safe. Owned by the coordinator's core thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/core/journal.h"
#include "coordinator/store/record_log.h"
#include "renderer/util/result.h"

namespace tessera {

constexpr size_t kFactBytesMax = size_t{64} << 20;        // above any message, so above any job
constexpr uint64_t kJournalBytesMin = uint64_t{4} << 20;  // smaller ones are not worth a new file
// Kept on the disk for facts that let space be freed: far more than the ends of all open jobs and what else
// may wait when the disk becomes full.
constexpr uint64_t kJournalReserveBytes = uint64_t{1} << 20;

class FileJournal : public Journal {
 public:
  // Opens or creates the file and calls `restore` with the facts in it, in order.
  static Result<std::unique_ptr<FileJournal>> Open(const std::string& path,
                                                   const std::function<void(const Fact&)>& restore,
                                                   const RecordLog::OnTorn& on_torn = {});

  void Append(const Fact& fact) override;
  Result<void> Sync(Room room = Room::kFree) override;
  bool IsLarge() const override;
  Result<void> Replace(const std::vector<Fact>& facts) override;

 private:
  FileJournal(std::string path, std::unique_ptr<RecordLog> log)
      : path_(std::move(path)), log_(std::move(log)) {}
  Result<void> SyncName();

  std::string path_;
  std::unique_ptr<RecordLog> log_;
  bool is_name_synced_ = true;
  uint64_t counting_bytes_ = 0;  // of the file when it was replaced last
};

}  // namespace tessera
