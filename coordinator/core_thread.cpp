#include "coordinator/core_thread.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// People do not notice more frequent updates.
constexpr Instant kWatchInterval = milliseconds(250);
constexpr Instant kSyncRetry = milliseconds(1000);  // after a failure of the disk
constexpr Instant kCompactInterval = seconds(10);   // of the journal
constexpr Instant kPatienceMin = milliseconds(1);

Instant Now() {
  return std::chrono::duration_cast<Instant>(std::chrono::steady_clock::now().time_since_epoch());
}

// What watchers are told when it changes. The rate and the times change always, so they are sent with the
// rest alone. A member that is added to JobStatus does not compile until it is named here.
auto NewsOf(const JobStatus& status) {
  const auto& [job, name, owner, priority, state, reason, samples_done, samples_total, samples_per_second,
               workers, elapsed, left, frames_total, frames_finished, frames_failed, noise, times,
               paused_by_user, verify_share, units_verified, units_disputed, units_suspect, submission] =
      status;
  return std::tie(job, name, owner, priority, state, reason, samples_done, samples_total, workers,
                  frames_total, frames_finished, frames_failed, noise, paused_by_user, verify_share,
                  units_verified, units_disputed, units_suspect, submission);
}

// The fewest nodes that hold the same sums.
Result<std::vector<TileNode>> Merged(const FrameSpec& spec, std::vector<TileNode> nodes) {
  Merger merger(spec);
  for (TileNode& node : nodes) {
    if (const auto added = merger.Add(std::move(node)); !added) return added.error();
  }
  return merger.TakeNodes();
}

}  // namespace

PendingAnswers::OnDirective PendingAnswers::TakeDirective(CallId call) {
  const auto found = directives_.find(call);
  if (found == directives_.end()) return {};
  OnDirective answer = std::move(found->second);
  directives_.erase(found);
  return answer;
}

CoreThread::CoreThread(Parts parts) : parts_(std::move(parts)) {
  NoteOpenJobs();
  members_->Set(parts_.farm->membership());
  thread_ = std::thread([this] { Run(); });
}

CoreThread::~CoreThread() {
  Stop();
}

void CoreThread::Post(Event event) {
  {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::move(event));
  }
  posted_.notify_one();
}

void CoreThread::Close() {
  Post([this](CoreContext&) { closing_ = true; });
}

void CoreThread::Stop() {
  parts_.pictures->Stop();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  posted_.notify_one();
  if (thread_.joinable()) thread_.join();
}

std::vector<CoreThread::Event> CoreThread::WaitForEvents(Instant patience) {
  std::unique_lock lock(mutex_);
  posted_.wait_for(lock, patience, [this] { return !events_.empty() || stopping_; });
  return std::exchange(events_, {});
}

void CoreThread::Run() {
  parts_.farm->Begin(
      Now(), std::chrono::duration_cast<milliseconds>(std::chrono::system_clock::now().time_since_epoch()));
  while (true) {
    std::vector<Event> events = WaitForEvents(Patience(Now()));
    const Instant now = Now();
    CoreContext context{*parts_.farm, now, answers_};
    for (Event& event : events) event(context);
    parts_.farm->Advance(now);
    parts_.farm->counters().core_s += Seconds(Now() - now);
    Deliver(parts_.farm->TakeOutput());
    if (closing_) {
      for (const auto& [call, answer] : std::exchange(answers_.directives_, {})) answer(nullptr);
    }
    NotifyWatchers(now);
    const std::lock_guard lock(mutex_);
    if (stopping_ && events_.empty()) return;
  }
}

Instant CoreThread::Patience(Instant now) const {
  Instant patience = parts_.farm->Patience(now);
  if (!answers_.watchers_.empty()) patience = std::min(patience, watchers_due_ - now);
  if (!unsynced_.empty()) patience = std::min(patience, sync_due_ - now);
  return std::max(patience, kPatienceMin);
}

// Keep, sync, answer.
void CoreThread::Deliver(FarmOutput output) {
  for (const std::string& line : output.log) spdlog::info("{}", line);
  parts_.on_output(output);
  for (auto& [frame, node] : std::exchange(output.accepted, {})) parts_.spool->Append(frame, std::move(node));
  for (const Fact& fact : output.facts) {
    parts_.journal->Append(fact);
    has_facts_ = true;
    if (FreesSpace(fact)) {
      frees_space_ = true;
      reserve_due_ = {};
    }
    NoteOpenJobs(fact);
    members_->Note(fact);
    // Watchers learn of an end immediately.
    if (std::holds_alternative<JobEnded>(fact)) watchers_due_ = {};
  }
  unsynced_.push_back(std::move(output));
  const auto synced = Sync();
  const auto facts_synced = SyncFacts(synced);
  for (const auto& answer : std::exchange(answers_.after_sync_, {})) answer(facts_synced);
  if (!synced) {
    GiveUpSums();
    if (closing_) Abandon();
    return;
  }
  for (FarmOutput& each : std::exchange(unsynced_, {})) Answer(std::move(each));
  if (std::exchange(wants_space_, false)) GiveUpSums();
  Compact();
}

void CoreThread::NoteOpenJobs() {
  for (const JobStatus& job : parts_.farm->Jobs(Now())) {
    if (!HasEnded(job.state)) open_jobs_.Set(job.job, parts_.farm->Spec(job.job));
  }
}

// A job may have ended by the time its first fact is delivered; then another fact follows.
void CoreThread::NoteOpenJobs(const Fact& fact) {
  if (const auto* submitted = std::get_if<JobSubmitted>(&fact)) {
    open_jobs_.Set(submitted->job, submitted->spec);
  } else if (const auto* ordered = std::get_if<JobOrdered>(&fact)) {
    if (auto spec = parts_.farm->Spec(ordered->job)) open_jobs_.Set(ordered->job, std::move(spec));
  } else if (const auto* extended = std::get_if<JobExtended>(&fact)) {
    if (auto spec = parts_.farm->Spec(extended->job)) open_jobs_.Set(extended->job, std::move(spec));
  } else if (const auto* ended = std::get_if<JobEnded>(&fact)) {
    open_jobs_.Remove(ended->job);
  }
}

// Sums that are kept for later make way for what must be written now. A frame whose end is not journalled yet
// still needs its sums.
void CoreThread::GiveUpSums() {
  if (!parts_.is_disk_low()) return;
  std::set<FrameId> needed;
  for (const FarmOutput& output : unsynced_) {
    for (const Fact& fact : output.facts) {
      if (const auto* finished = std::get_if<FrameFinished>(&fact))
        needed.insert({finished->job, finished->frame});
    }
  }
  for (const FrameId frame : parts_.farm->GiveUpSums(needed)) parts_.spool->Drop(frame);
}

void CoreThread::Answer(FarmOutput output) {
  for (const auto& answer : output.results) {
    if (const auto waiting = answers_.results_.extract(answer.call)) waiting.mapped()(&answer);
  }
  for (const auto& answer : output.directives) {
    if (const auto waiting = answers_.TakeDirective(answer.call)) waiting(&answer.directive);
  }
  for (FinishedPicture& picture : output.pictures) WritePicture(std::move(picture));
  for (FinishedPicture& picture : output.partial_pictures) WritePicture(std::move(picture));
  for (auto& [frame, nodes] : output.sums) parts_.spool->Replace(frame, std::move(nodes));
  for (const FrameId frame : output.dropped) parts_.spool->Drop(frame);
  for (const FrameId frame : output.loads) Load(frame);
  for (const JobId job : output.forgotten) parts_.pictures->Remove(job);
}

// Merges what was loaded, as far as that is possible, before the core thread gets it.
void CoreThread::Load(FrameId frame) {
  const auto spec = parts_.farm->Spec(frame.job);
  parts_.spool->Load(frame, [this, frame, spec](Result<std::vector<TileNode>> nodes) {
    const auto shared = std::make_shared<Result<std::vector<TileNode>>>(
        nodes && spec ? Merged(spec->frames[frame.frame].spec, std::move(*nodes)) : std::move(nodes));
    Post([=](CoreContext& core) { core.farm.SumsLoaded(core.now, frame, std::move(*shared)); });
  });
}

void CoreThread::WritePicture(FinishedPicture picture) {
  const FrameId frame{picture.job, picture.frame};
  parts_.pictures->Write(std::move(picture), [this, frame](const Result<WrittenPicture>& written) {
    Post([=, this](CoreContext& core) {
      if (!written) {
        // The coordinator stops, and the next one makes the picture.
        if (written.error().kind == ErrorKind::kInterrupted) return;
        wants_space_ = true;
        return core.farm.PictureDelayed(core.now, frame, written.error().message);
      }
      if (!written->denoise_failed.empty()) core.farm.PictureNotDenoised(frame, written->denoise_failed);
      core.farm.counters().picture_s += written->seconds;
      core.farm.PictureWritten(core.now, frame, written->file);
    });
  });
}

Result<void> CoreThread::Sync() {
  if (Now() < sync_due_ && !closing_) return Failed(parts_.farm->storage_reason());
  const Instant begun = Now();
  for (const FrameId frame : parts_.spool->Grown()) {
    if (auto nodes = parts_.farm->Sums(frame)) parts_.spool->Replace(frame, std::move(*nodes));
  }
  auto synced = parts_.spool->Sync();
  if (synced) synced = parts_.journal->Sync();
  parts_.farm->counters().journal_s += Seconds(Now() - begun);
  ++parts_.farm->counters().journal_syncs;
  parts_.farm->StorageDelayed(synced ? "" : synced.error().message);
  if (!synced) {
    sync_due_ = Now() + kSyncRetry;
    parts_.on_storage_failure();
  }
  if (!synced && closing_) return Error{ErrorKind::kInterrupted, "the coordinator is shutting down"};
  return synced;
}

// Whether all facts are on stable storage, whatever has become of the results. If the disk refuses them and
// some free space, the reserve takes them all, ahead of results that they follow: a crash would lose these
// results, which nobody has been told of, and the facts do not name what they contain. What is dropped once
// more later is gone by then.
Result<void> CoreThread::SyncFacts(const Result<void>& synced) {
  const bool is_refused = !synced && has_facts_;
  if (is_refused && (!frees_space_ || Now() < reserve_due_)) return synced;
  if (is_refused) {
    if (const auto kept = parts_.journal->Sync(Room::kReserve); !kept) {
      reserve_due_ = Now() + kSyncRetry;
      return closing_ ? synced : kept;
    }
    for (const FarmOutput& output : unsynced_) {
      for (const FrameId frame : output.dropped) parts_.spool->Drop(frame);
    }
  }
  has_facts_ = frees_space_ = false;
  return {};
}

// A failure does no harm: the journal stays as it was and is tried again later.
void CoreThread::Compact() {
  if (!parts_.journal->IsLarge() || Now() < compact_due_) return;
  compact_due_ = Now() + kCompactInterval;
  const auto replaced = parts_.journal->Replace(parts_.farm->Snapshot());
  if (!replaced) spdlog::warn("journal_not_compacted reason={}", LogText(replaced.error().message));
}

// The coordinator ends before the disk took the facts: they must not be acknowledged, but no call may wait
// either.
void CoreThread::Abandon() {
  for (const auto& [call, answer] : std::exchange(answers_.results_, {})) answer(nullptr);
  for (const auto& [call, answer] : std::exchange(answers_.directives_, {})) answer(nullptr);
}

void CoreThread::NotifyWatchers(Instant now) {
  const bool all = now >= watchers_due_ || closing_;
  if (all) watchers_due_ = now + kWatchInterval;
  std::erase_if(answers_.watchers_, [&](PendingAnswers::Watcher& watcher) {
    if (watcher.sent && !all) return false;
    if (!watcher.is_watched()) return true;
    if (closing_) {
      watcher.offer(nullptr, true);
      return true;
    }
    const auto status = parts_.farm->Status(now, watcher.job);
    const bool last = !status || HasEnded(status->state);
    // A crash could still undo the end.
    if (last && has_facts_) return false;
    if (!last && watcher.sent && NewsOf(*watcher.sent) == NewsOf(*status)) return false;
    watcher.sent = status;
    return !watcher.offer(status ? &*status : nullptr, last) || last;
  });
  watcher_count_ = answers_.watchers_.size();
}

}  // namespace tessera
