#include "coordinator/web/api/farm_watch.h"

#include <algorithm>
#include <utility>

namespace tessera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kFreshAge{500};
constexpr milliseconds kReadInterval{1000};
constexpr seconds kInterest{5};  // views are read for this long after somebody has asked
// Pauses between views, in multiples of their cost.
constexpr int kPausesPerView = 100;
constexpr int kPausesPerKeptView = 500;
constexpr int kPausesPerAskedView = 20;

template <typename Ring>
void Push(Ring& ring, typename Ring::value_type value) {
  ring.push_back(std::move(value));
  if (ring.size() > kHistoryPoints) ring.pop_front();
}

}  // namespace

FarmWatch::FarmWatch(ReadView read) : read_view_(std::move(read)), thread_([this] { Run(); }) {}

FarmWatch::~FarmWatch() {
  Stop();
}

void FarmWatch::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void FarmWatch::Ask(std::function<void(const Moment&)> done) {
  Moment fresh;
  {
    const std::lock_guard lock(mutex_);
    wanted_ = Clock::now();
    const auto age_max = std::max<Clock::duration>(kFreshAge, kPausesPerAskedView * cost_);
    if (!stopping_ && latest_ != nullptr && wanted_ - read_at_ < age_max) {
      fresh = latest_;
    } else if (!stopping_) {
      waiting_.push_back(std::move(done));
      changed_.notify_all();
      return;
    }
  }
  done(fresh);
}

FarmWatch::Moment FarmWatch::Latest() {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  const bool was_idle = now - wanted_ > kInterest;
  wanted_ = now;
  if (was_idle) changed_.notify_all();
  return latest_;
}

std::vector<HistoryPoint> FarmWatch::History() const {
  const std::lock_guard lock(mutex_);
  return {history_.begin(), history_.end()};
}

std::vector<std::array<float, 2>> FarmWatch::HistoryOf(WorkerId worker) const {
  const std::lock_guard lock(mutex_);
  const auto found = workers_.find(worker);
  if (found == workers_.end()) return {};
  return {found->second.begin(), found->second.end()};
}

// When the next view is due, with the mutex held.
FarmWatch::Clock::time_point FarmWatch::NextDue() const {
  if (!waiting_.empty()) return Clock::time_point();
  const auto kept = kept_ + std::max<Clock::duration>(kHistoryInterval, kPausesPerKeptView * cost_);
  if (read_at_ > wanted_ + kInterest) return kept;
  return std::min(kept, read_at_ + std::max<Clock::duration>(kReadInterval, kPausesPerView * cost_));
}

void FarmWatch::Run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (Clock::now() >= NextDue()) {
      Read(lock);
    } else {
      changed_.wait_until(lock, NextDue());
    }
  }
  for (const auto& done : std::exchange(waiting_, {})) done(nullptr);
}

// Without the mutex while it waits for the farm.
void FarmWatch::Read(std::unique_lock<std::mutex>& lock) {
  const auto waiting = std::exchange(waiting_, {});
  const auto start = Clock::now();
  lock.unlock();
  auto view = read_view_();
  lock.lock();
  read_at_ = Clock::now();
  cost_ = read_at_ - start;
  Moment moment;
  if (view) {
    if (read_at_ - kept_ >= kHistoryInterval) Keep(*view);
    moment = std::make_shared<const FarmMoment>(
        FarmMoment{std::move(*view), latest_ != nullptr ? latest_->number + 1 : 1});
    latest_ = moment;
  } else {
    kept_ = std::max(kept_, read_at_ - kHistoryInterval + kReadInterval);
  }
  lock.unlock();
  for (const auto& done : waiting) done(moment);
  moment.reset();
  lock.lock();
}

void FarmWatch::Keep(const FarmView& view) {
  kept_ = read_at_;
  HistoryPoint point;
  point.unix_time_s =
      std::chrono::duration_cast<seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  point.slots_leased = view.slots.leased;
  point.slots = view.slots.leased + view.slots.fetching + view.slots.loading + view.slots.idle;
  point.workers = static_cast<int>(view.workers.size());
  for (const JobStatus& job : view.jobs) {
    if (HasEnded(job.state)) continue;
    ++point.jobs_open;
    point.samples_per_second += job.samples_per_second;
  }
  point.samples_left = view.samples_left;
  point.blob_bytes = view.blob_bytes;
  point.disk_free = view.disk_free;
  point.results_bytes = view.traffic.results_in;
  for (const WorkerStatus& worker : view.workers) point.units_failed += worker.units_failed;
  Push(history_, point);
  std::map<WorkerId, std::deque<std::array<float, 2>>> kept;
  for (const WorkerStatus& worker : view.workers) {
    if (kept.size() == kWorkersWithHistoryMax) break;
    auto& ring = kept[worker.worker];
    if (const auto known = workers_.find(worker.worker); known != workers_.end())
      ring = std::move(known->second);
    Push(ring, {static_cast<float>(worker.samples_per_second), static_cast<float>(worker.utilisation)});
  }
  workers_ = std::move(kept);
}

}  // namespace tessera
