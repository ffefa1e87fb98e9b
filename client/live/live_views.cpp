#include "client/live/live_views.h"

#include <algorithm>

#include "proto/shell/console.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kPauseMin{1000};
constexpr int kPausePerCost = 20;
constexpr size_t kWarningsMax = 10;  // of one view: different ones, such as the errors of a broken network
constexpr milliseconds kRetryPause{100};  // if there is no picture yet
constexpr milliseconds kIdleSlice{100};   // as fast as a terminal that changes its size is noticed

}  // namespace

milliseconds PauseAfter(milliseconds cost) {
  return std::max(kPauseMin, cost * kPausePerCost);
}

LiveViews::LiveViews(const std::stop_token& stop)
    : threads_([](Error why) { PrintNote("tessera: warning: {}; the render continues\n", why.message); }),
      on_stop_(stop, [this] { stop_.request_stop(); }) {}

LiveViews::~LiveViews() {
  stop_.request_stop();
  threads_.Join();
}

Result<void> LiveViews::Add(std::unique_ptr<PictureSource> source, std::unique_ptr<PictureView> view) {
  PictureSource& added_source = *sources_.emplace_back(std::move(source));
  PictureView& added_view = *views_.emplace_back(std::move(view));
  {
    const std::lock_guard lock(mutex_);
    ++running_;
  }
  auto started = threads_.Start([this, &added_source, &added_view] { Run(added_source, added_view); });
  if (!started) {
    const std::lock_guard lock(mutex_);
    --running_;
  }
  return started;
}

void LiveViews::Finish(milliseconds patience) {
  {
    std::unique_lock lock(mutex_);
    is_finishing_ = true;
    changed_.notify_all();
    changed_.wait_for(lock, patience, [this] { return running_ == 0; });
  }
  stop_.request_stop();
  threads_.Join();
}

void LiveViews::Run(PictureSource& source, PictureView& view) {
  // Whatever ends the thread.
  struct Ending {
    LiveViews& views;
    ~Ending() {
      const std::lock_guard lock(views.mutex_);
      --views.running_;
      views.changed_.notify_all();
    }
  } ending{*this};
  std::set<std::string> warnings;
  milliseconds pause = kRetryPause;
  while (Wait(pause, view)) {
    const auto start = Clock::now();
    const bool has_shown = ShowNext(source, view, warnings);
    const auto cost = std::chrono::duration_cast<milliseconds>(Clock::now() - start);
    pause = has_shown ? PauseAfter(cost) : std::max(kRetryPause, cost * kPausePerCost);
  }
  if (!stop_.stop_requested()) ShowNext(source, view, warnings);
}

bool LiveViews::ShowNext(PictureSource& source, PictureView& view, std::set<std::string>& warnings) {
  const auto warn = [&](const Error& why) {
    if (stop_.stop_requested() || warnings.size() == kWarningsMax) return;
    if (!warnings.insert(why.message).second) return;
    PrintNote("\ntessera: warning: {}; the render continues\n", why.message);
  };
  const auto picture = source.Next(stop_.get_token());
  if (!picture) warn(picture.error());
  if (!picture || !*picture) return false;
  const auto shown = view.Show(**picture, stop_.get_token());
  if (!shown) warn(shown.error());
  return true;
}

bool LiveViews::Wait(milliseconds duration, PictureView& view) {
  const auto end = Clock::now() + duration;
  std::unique_lock lock(mutex_);
  while (!is_finishing_ && !stop_.stop_requested()) {
    const auto now = Clock::now();
    if (now >= end) return true;
    changed_.wait_until(lock, std::min(end, now + kIdleSlice));
    lock.unlock();
    view.Idle();
    lock.lock();
  }
  return false;
}

}  // namespace tessera
