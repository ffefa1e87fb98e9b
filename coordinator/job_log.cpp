#include "coordinator/job_log.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr size_t kEntryBytes = 160;         // besides its text
constexpr size_t kUnwrittenMax = 20'000;    // while the disk does not take any
constexpr uint64_t kFileSlack = 4u << 20u;  // before the file is made anew

size_t BytesOf(const JobLogEntry& entry) {
  return kEntryBytes + entry.text.size();
}

int64_t UnixTimeMs() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

std::string JobLog::Restore(const std::vector<JobStatus>& jobs) {
  const std::lock_guard file_lock(file_mutex_);
  const std::lock_guard lock(mutex_);
  for (const JobStatus& job : jobs) jobs_[job.job] = {job.submission, HasEnded(job.state), {}};
  const auto keep = [&](StoredMessage message) {
    const auto known = jobs_.find(message.job);
    if (known == jobs_.end() || known->second.submission != message.submission) return;
    if (message.entry.number > last_) Keep(message.job, known->second, std::move(message.entry));
  };
  auto opened = MessageFile::Open(path_, keep);
  std::string problem;
  if (!opened) {
    problem = opened.error().message;
    opened = MessageFile::Create(path_);
  }
  if (opened) {
    file_.emplace(std::move(*opened));
  } else {
    problem = opened.error().message;
  }
  return problem;
}

void JobLog::Note(const FarmOutput& output) {
  if (output.messages.empty() && output.forgotten.empty()) return;
  const std::lock_guard lock(mutex_);
  for (const JobMessage& message : output.messages) Note(message);
  for (const JobId job : output.forgotten) {
    const auto known = jobs_.find(job);
    if (known == jobs_.end()) continue;
    while (!known->second.entries.empty()) RemoveOldest(known->second);
    jobs_.erase(known);
  }
  WriteLater();
}

// With the mutex held, as the functions below.
void JobLog::Note(const JobMessage& message) {
  if (message.submission == 0) return;  // the job is forgotten
  OfJob& log = jobs_[message.job];
  log.submission = message.submission;
  if (message.change) log.has_ended = *message.change == JobMessage::Change::kEnds;
  const int64_t now = UnixTimeMs();
  const uint64_t number = std::max(last_ + 1, static_cast<uint64_t>(std::max<int64_t>(now, 1)));
  JobLogEntry entry{number, now, message.level, CleanText(message.text, kReasonBytesMax)};
  if (unwritten_.size() < kUnwrittenMax) unwritten_.push_back({message.job, message.submission, entry});
  Keep(message.job, log, std::move(entry));
}

void JobLog::Keep(JobId job, OfJob& log, JobLogEntry entry) {
  last_ = entry.number;
  bytes_ += BytesOf(entry);
  ages_[entry.number] = job;
  log.entries.push_back(std::move(entry));
  if (log.entries.size() > kLogEntriesPerJobMax) RemoveOldest(log);
  while (bytes_ > kLogBytesMax) RemoveOldest(jobs_.at(ages_.begin()->second));
}

void JobLog::RemoveOldest(OfJob& log) {
  bytes_ -= BytesOf(log.entries.front());
  ages_.erase(log.entries.front().number);
  log.entries.pop_front();
}

void JobLog::WriteLater() {
  if (unwritten_.empty() || std::exchange(is_writing_, true)) return;
  run_later_([this] { Flush(); });
}

std::optional<JobLogPage> JobLog::Read(JobId job, uint64_t after, size_t limit) const {
  const std::lock_guard lock(mutex_);
  const auto known = jobs_.find(job);
  if (known == jobs_.end()) return std::nullopt;
  const std::deque<JobLogEntry>& entries = known->second.entries;
  auto next = std::ranges::upper_bound(entries, after, {}, &JobLogEntry::number);
  JobLogPage page;
  for (; next != entries.end() && page.entries.size() < limit; ++next) page.entries.push_back(*next);
  page.has_more = next != entries.end();
  page.has_ended = known->second.has_ended && !page.has_more;
  return page;
}

void JobLog::Flush() {
  const std::lock_guard file_lock(file_mutex_);
  std::vector<StoredMessage> messages;
  {
    const std::lock_guard lock(mutex_);
    messages = std::exchange(unwritten_, {});
    is_writing_ = false;
  }
  // What cannot be written is not in the file after the next start. It stays in memory until then.
  if (file_) static_cast<void>(Write(messages));
}

Result<void> JobLog::Write(const std::vector<StoredMessage>& messages) {
  if (file_->has_pending()) {
    if (auto earlier = file_->Sync(); !earlier) return earlier;
  }
  for (const StoredMessage& message : messages) file_->Append(message);
  if (auto synced = file_->Sync(); !synced) return synced;
  const std::vector<StoredMessage> all = file_->bytes() > kFileSlack ? All() : std::vector<StoredMessage>();
  size_t bytes = 0;
  for (const StoredMessage& message : all) bytes += BytesOf(message.entry);
  if (file_->bytes() < 2 * bytes + kFileSlack) return {};
  auto fresh = MessageFile::Create(path_);
  if (!fresh) return fresh.error();
  file_.emplace(std::move(*fresh));
  for (const StoredMessage& message : all) file_->Append(message);
  return file_->Sync();
}

std::vector<StoredMessage> JobLog::All() const {
  const std::lock_guard lock(mutex_);
  std::vector<StoredMessage> all;
  for (const auto& [number, job] : ages_) {
    const OfJob& log = jobs_.at(job);
    const auto entry = std::ranges::lower_bound(log.entries, number, {}, &JobLogEntry::number);
    all.push_back({job, log.submission, *entry});
  }
  return all;
}

}  // namespace tessera
