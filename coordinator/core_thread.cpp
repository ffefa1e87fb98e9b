#include "coordinator/core_thread.h"

#include <spdlog/spdlog.h>

#include <algorithm>

namespace tessera {
namespace {

using std::chrono::milliseconds;

constexpr Instant kWatchInterval = milliseconds(250);  // people see no more
constexpr Instant kSyncRetry = milliseconds(1000);     // after a failure of the disk
constexpr Instant kPatienceMin = milliseconds(1);

Instant Now() {
  return std::chrono::duration_cast<Instant>(std::chrono::steady_clock::now().time_since_epoch());
}

bool IsSame(const JobStatus& a, const JobStatus& b) {
  return a.state == b.state && a.samples_done == b.samples_done && a.frames_finished == b.frames_finished &&
         a.workers == b.workers && a.reason == b.reason && a.priority == b.priority;
}

}  // namespace

PendingAnswers::OnDirective PendingAnswers::TakeDirective(CallId call) {
  const auto found = directives_.find(call);
  if (found == directives_.end()) return {};
  OnDirective answer = std::move(found->second);
  directives_.erase(found);
  return answer;
}

CoreThread::CoreThread(std::unique_ptr<Farm> farm, std::unique_ptr<Journal> journal,
                       std::function<void(FinishedPicture)> write_picture)
    : farm_(std::move(farm)),
      journal_(std::move(journal)),
      write_picture_(std::move(write_picture)),
      thread_([this] { Run(); }) {}

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
  farm_->Begin(Now());
  while (true) {
    std::vector<Event> events = WaitForEvents(Patience(Now()));
    const Instant now = Now();
    CoreContext context{*farm_, now, answers_};
    for (Event& event : events) event(context);
    farm_->Advance(now);
    Deliver(farm_->TakeOutput());
    if (closing_) {
      for (const auto& [call, answer] : std::exchange(answers_.directives_, {})) answer(nullptr);
    }
    TellWatchers(now);
    const std::lock_guard lock(mutex_);
    if (stopping_ && events_.empty()) return;
  }
}

Instant CoreThread::Patience(Instant now) const {
  Instant patience = farm_->Patience(now);
  if (!answers_.watchers_.empty()) patience = std::min(patience, watchers_due_ - now);
  if (!unsynced_.empty()) patience = std::min(patience, sync_due_ - now);
  return std::max(patience, kPatienceMin);
}

// Journal, sync, answer.
void CoreThread::Deliver(FarmOutput output) {
  for (const std::string& line : output.log) spdlog::info("{}", line);
  for (const Fact& fact : output.facts) {
    journal_->Append(fact);
    if (std::holds_alternative<JobEnded>(fact)) watchers_due_ = {};  // people hear of an end at once
  }
  unsynced_.push_back(std::move(output));
  if (!Sync()) {
    if (closing_) Abandon();
    return;
  }
  for (FarmOutput& each : std::exchange(unsynced_, {})) {
    for (const auto& answer : each.results) {
      if (const auto waiting = answers_.results_.extract(answer.call)) waiting.mapped()(&answer);
    }
    for (const auto& answer : each.directives) {
      if (const auto waiting = answers_.TakeDirective(answer.call)) waiting(&answer.directive);
    }
    for (FinishedPicture& picture : each.pictures) write_picture_(std::move(picture));
  }
  for (const auto& answer : std::exchange(answers_.after_sync_, {})) answer(true);
}

bool CoreThread::Sync() {
  if (Now() < sync_due_ && !closing_) return false;
  const auto synced = journal_->Sync();
  if (synced) return true;
  spdlog::error("journal_delayed reason=\"{}\"", synced.error().message);
  sync_due_ = Now() + kSyncRetry;
  return false;
}

// The end has come before the disk took the facts: nobody may hear of them, but nobody may wait either.
void CoreThread::Abandon() {
  for (const auto& [call, answer] : std::exchange(answers_.results_, {})) answer(nullptr);
  for (const auto& [call, answer] : std::exchange(answers_.directives_, {})) answer(nullptr);
  for (const auto& answer : std::exchange(answers_.after_sync_, {})) answer(false);
}

void CoreThread::TellWatchers(Instant now) {
  if (!unsynced_.empty() && !closing_) return;  // what they would hear might be forgotten
  const bool all = now >= watchers_due_ || closing_;
  if (all) watchers_due_ = now + kWatchInterval;
  std::erase_if(answers_.watchers_, [&](PendingAnswers::Watcher& watcher) {
    if (watcher.told && !all) return false;
    if (closing_) {
      watcher.offer(nullptr, true);
      return true;
    }
    const auto status = farm_->Status(now, watcher.job);
    const bool last = !status || HasEnded(status->state);
    if (!last && watcher.told && IsSame(*watcher.told, *status)) return false;
    watcher.told = status;
    return !watcher.offer(status ? &*status : nullptr, last) || last;
  });
}

}  // namespace tessera
