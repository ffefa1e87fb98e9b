#include "worker/activity_meter.h"

#include <algorithm>

namespace tessera {
namespace {

uint64_t Milliseconds(std::chrono::nanoseconds time) {
  return static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::milliseconds>(time).count());
}

}  // namespace

void ActivityMeter::Pass(TimePoint now) {
  if (now <= at_) return;
  const std::chrono::nanoseconds passed = now - at_;
  at_ = now;
  busy_time_ += passed * busy_;
  std::chrono::nanoseconds& rest = loader_ == Loader::kFetching  ? fetching_time_
                                   : loader_ == Loader::kLoading ? loading_time_
                                                                 : idle_time_;
  rest += passed * std::max(slots_ - busy_, 0);
}

void ActivityMeter::SlotBegins(TimePoint now) {
  const std::lock_guard lock(mutex_);
  Pass(now);
  ++busy_;
}

void ActivityMeter::SlotEnds(TimePoint now) {
  const std::lock_guard lock(mutex_);
  Pass(now);
  --busy_;
}

void ActivityMeter::LoaderDoes(Loader what, TimePoint now) {
  const std::lock_guard lock(mutex_);
  Pass(now);
  loader_ = what;
}

void ActivityMeter::Fetched(uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  bytes_fetched_ += bytes;
}

void ActivityMeter::Fill(WorkerState& state, TimePoint now) {
  const std::lock_guard lock(mutex_);
  Pass(now);
  state.activity = {Milliseconds(busy_time_), Milliseconds(fetching_time_), Milliseconds(loading_time_),
                    Milliseconds(idle_time_), bytes_fetched_};
  for (HeldScene& scene : state.scenes) scene.fetching = !scene.ready && loader_ == Loader::kFetching;
}

}  // namespace tessera
