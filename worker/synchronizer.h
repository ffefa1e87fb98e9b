// Exchanges states with the coordinator: what this worker holds and does, for what it should hold and do.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "proto/shell/backoff.h"
#include "proto/terms.h"
#include "renderer/util/result.h"
#include "worker/activity_meter.h"
#include "worker/outage_report.h"
#include "worker/prefetcher.h"
#include "worker/shared_workload.h"

namespace grpc {
class Channel;
}

namespace tessera {

// Keeps one call open all the time, makes another when there is news, and calls again, with back-off, when
// the connection breaks. NotifyNews is thread safe; everything else belongs to the thread that calls Run.
class Synchronizer {
 public:
  // `channel` leads to `endpoint`, which messages name. `self` holds what never changes: worker, name, slots,
  // versions. `on_refusal` is called if the coordinator will never admit this worker.
  Synchronizer(std::shared_ptr<grpc::Channel> channel, const Endpoint& endpoint, WorkerState self,
               SharedWorkload& workload, ActivityMeter& meter, Prefetcher& prefetcher,
               std::function<void(Error)> on_refusal);
  ~Synchronizer();
  Synchronizer(const Synchronizer&) = delete;
  Synchronizer& operator=(const Synchronizer&) = delete;

  // There is news that the coordinator should learn of.
  void NotifyNews();
  // Exchanges states until a stop is requested.
  void Run(std::stop_token stop);
  // Tells the coordinator that this worker leaves; call it after Run. Waits at most `patience` for the
  // answer.
  void Leave(std::chrono::milliseconds patience);

 private:
  struct Call;
  void Start();
  void Handle(const Call& call);
  void HandleDirective(const Call& call);
  std::chrono::steady_clock::time_point NextWakeup() const;

  std::shared_ptr<grpc::Channel> channel_;
  WorkerState self_;
  SharedWorkload& workload_;
  ActivityMeter& meter_;
  Prefetcher& prefetcher_;
  const std::function<void(Error)> on_refusal_;
  Backoff backoff_, join_backoff_;
  std::chrono::steady_clock::time_point next_call_;   // unless there is news
  std::chrono::steady_clock::time_point next_retry_;  // after a failure, news or not
  std::vector<std::unique_ptr<Call>> open_;
  std::string notice_;
  bool connected_ = false;
  OutageReport outage_;

  std::mutex mutex_;  // of the members below
  std::condition_variable_any changed_;
  bool news_ = false;
  std::deque<Call*> finished_;  // of those open
};

}  // namespace tessera
