// Measures what the slots of this worker spend their time on. Time is passed in.
#pragma once

#include <chrono>
#include <mutex>

#include "proto/terms.h"

namespace tessera {

// Thread safe.
class ActivityMeter {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  // What the thread that loads scenes does, which is why slots wait.
  enum class Loader { kIdle, kFetching, kLoading };

  ActivityMeter(int slots, TimePoint now) : slots_(slots), at_(now) {}
  // A slot starts or stops rendering.
  void SlotBegins(TimePoint now);
  void SlotEnds(TimePoint now);
  void LoaderDoes(Loader what, TimePoint now);
  void Fetched(uint64_t bytes);
  // Fills in the measurements, and which scenes of the state are being fetched.
  void Fill(WorkerState& state, TimePoint now);

 private:
  void Pass(TimePoint now);

  const int slots_;
  std::mutex mutex_;  // of the members below
  int busy_ = 0;
  Loader loader_ = Loader::kIdle;
  TimePoint at_;
  uint64_t bytes_fetched_ = 0;
  std::chrono::nanoseconds busy_time_{}, fetching_time_{}, loading_time_{}, idle_time_{};  // of slots
};

}  // namespace tessera
