// Reads the state of the farm for all who watch it: each view serves all of them, and the core thread spends
// at most one percent of its time on views. Also keeps what charts show of the last hour.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "coordinator/web/farm_view.h"

namespace tessera {

struct FarmMoment {
  FarmView view;
  uint64_t number = 0;  // of the view, from 1
};

// The farm every kHistoryInterval, oldest first.
struct HistoryPoint {
  int64_t unix_time_s = 0;
  double samples_per_second = 0;
  int slots_leased = 0, slots = 0, workers = 0, jobs_open = 0;
  uint64_t samples_left = 0, blob_bytes = 0, disk_free = 0, units_failed = 0, results_bytes = 0;
};
constexpr std::chrono::seconds kHistoryInterval{10};
constexpr size_t kHistoryPoints = 360;  // an hour
// Each takes 3 KB. Larger farms are monitored by other means.
constexpr size_t kWorkersWithHistoryMax = 2000;

// Thread safe.
class FarmWatch {
 public:
  using Clock = std::chrono::steady_clock;
  using Moment = std::shared_ptr<const FarmMoment>;
  using ReadView = std::function<std::optional<FarmView>()>;

  explicit FarmWatch(ReadView read);
  ~FarmWatch();
  // Ends the thread. Callers that wait receive null.
  void Stop();

  // Calls `done` with a moment that is not older than half a second or, on a farm whose views are expensive,
  // some more; with null if the farm is too busy.
  void Ask(std::function<void(const Moment&)> done);
  // The last moment, null before the first view. Views are read, about every second, while somebody asks
  // this.
  Moment Latest();

  std::vector<HistoryPoint> History() const;
  // Samples/s and utilisation of a worker, oldest first; empty if they are not kept.
  std::vector<std::array<float, 2>> HistoryOf(WorkerId worker) const;

 private:
  void Run();
  void Read(std::unique_lock<std::mutex>& lock);
  Clock::time_point NextDue() const;
  void Keep(const FarmView& view);

  const ReadView read_view_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_.
  bool stopping_ = false;
  Moment latest_;
  Clock::time_point read_at_{}, wanted_{}, kept_{};
  Clock::duration cost_{};
  std::vector<std::function<void(const Moment&)>> waiting_;
  std::deque<HistoryPoint> history_;
  std::map<WorkerId, std::deque<std::array<float, 2>>> workers_;

  std::thread thread_;
};

}  // namespace tessera
