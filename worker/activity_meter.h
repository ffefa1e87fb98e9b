// What the slots of this worker do with their time. Time comes in as an argument.
#pragma once

#include <chrono>
#include <mutex>

#include "proto/terms.h"

namespace tessera {

// Thread safe.
class ActivityMeter {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  // What the thread that gets scenes does: it is why slots without work have none.
  enum class Loader { kIdle, kFetching, kLoading };

  ActivityMeter(int slots, TimePoint now) : slots_(slots), at_(now) {}
  // A slot begins, or ends, to render.
  void SlotBegins(TimePoint now);
  void SlotEnds(TimePoint now);
  void LoaderDoes(Loader what, TimePoint now);
  void Fetched(uint64_t bytes);
  // Puts into the state what has been measured, and which of its scenes are being fetched.
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
