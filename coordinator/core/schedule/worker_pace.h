// How busy a worker was recently, from the counters that it sends and from the results accepted from it.
#pragma once

#include <algorithm>
#include <deque>

#include "coordinator/core/schedule/instant.h"
#include "proto/terms.h"

namespace tessera {

class WorkerPace {
 public:
  // What the worker has done in all; the counters only grow.
  void Record(Instant now, const WorkerActivity& activity) {
    latest_ = {now, activity.busy_ms, samples_};
    if (!marks_.empty() && now - marks_.back().at < kMarkInterval) return;
    marks_.push_back(latest_);
    while (marks_.size() > 2 && now - marks_[1].at >= kWindow) marks_.pop_front();
  }
  void Accept(uint64_t pixel_samples) { samples_ += pixel_samples; }
  // Share of the slots' time that was spent rendering: 0 to 1.
  double Utilisation(int slots) const {
    if (marks_.empty() || latest_.at <= marks_.front().at || latest_.busy_ms < marks_.front().busy_ms)
      return 0;
    const double busy_s = static_cast<double>(latest_.busy_ms - marks_.front().busy_ms) / 1000;
    return std::clamp(busy_s / (Seconds(latest_.at - marks_.front().at) * slots), 0.0, 1.0);
  }
  double SamplesPerSecond(Instant now) const {
    if (marks_.empty() || now <= marks_.front().at) return 0;
    return static_cast<double>(samples_ - marks_.front().samples) / Seconds(now - marks_.front().at);
  }

 private:
  static constexpr Instant kWindow = std::chrono::seconds(60);
  static constexpr Instant kMarkInterval = std::chrono::seconds(5);  // a dozen marks in the window
  struct Mark {
    Instant at{};
    uint64_t busy_ms = 0, samples = 0;
  };
  std::deque<Mark> marks_;
  Mark latest_;
  uint64_t samples_ = 0;
};

}  // namespace tessera
