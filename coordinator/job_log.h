// What happened to each job, for people: state changes, failures, warnings, with the time of day. The core
// decides what is worth a message (core/schedule/job_message.h); this keeps a bounded number of them. They
// are written to a file on another thread, so that they survive a restart. Nothing waits for that, and a
// crash may lose the last ones.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/core/farm_output.h"
#include "coordinator/store/message_file.h"
#include "proto/terms.h"

namespace tessera {

// Entries of one job: a job that fails at every attempt keeps its last hours.
constexpr size_t kLogEntriesPerJobMax = 500;
// Of all entries in memory. If more come, the oldest of all jobs are removed.
constexpr size_t kLogBytesMax = size_t{16} << 20;

// Thread safe.
class JobLog {
 public:
  using RunLater = std::function<void(std::function<void()> task)>;
  // Writes on the thread of `run_later`.
  JobLog(std::string path, RunLater run_later) : path_(std::move(path)), run_later_(std::move(run_later)) {}

  // Reads what former processes have written of the jobs that the farm knows. Call it first. Returns why that
  // was not possible, or an empty text; the log is then empty.
  std::string Restore(const std::vector<JobStatus>& jobs);
  void Note(const FarmOutput& output);
  // Entries with numbers larger than `after`, at most `limit`; nullopt if there is no such job.
  std::optional<JobLogPage> Read(JobId job, uint64_t after, size_t limit = kLogEntriesPerCallMax) const;
  // Writes what is not in the file yet.
  void Flush();

 private:
  struct OfJob {
    uint64_t submission = 0;
    bool has_ended = false;
    std::deque<JobLogEntry> entries;
  };
  void Note(const JobMessage& message);
  void Keep(JobId job, OfJob& log, JobLogEntry entry);
  void RemoveOldest(OfJob& log);
  void WriteLater();
  Result<void> Write(const std::vector<StoredMessage>& messages);
  std::vector<StoredMessage> All() const;

  const std::string path_;
  const RunLater run_later_;
  mutable std::mutex mutex_;
  // Guarded by mutex_.
  std::map<JobId, OfJob> jobs_;
  std::map<uint64_t, JobId> ages_;  // of all entries, by number
  size_t bytes_ = 0;
  uint64_t last_ = 0;  // number
  std::vector<StoredMessage> unwritten_;
  bool is_writing_ = false;

  std::mutex file_mutex_;
  std::optional<MessageFile> file_;  // guarded by file_mutex_
};

}  // namespace tessera
