// Logs that the coordinator is not reached or does not let this worker join for now: first after a moment,
// then less and less often.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "proto/wire/endpoint.h"
#include "proto/wire/reachability.h"

namespace tessera {

// A coordinator that restarts is often back sooner.
constexpr std::chrono::seconds kOutageReportFirst{1};
// Each interval between reports is this many times the last one, up to the maximum.
constexpr int kOutageReportGrowth = 4;
constexpr std::chrono::seconds kOutageReportIntervalMax{600};

// Not thread safe. Never waits: what a check finds out is logged after a later failure.
class OutageReport {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  explicit OutageReport(Endpoint endpoint) : endpoint_(std::move(endpoint)) {}
  // A call has failed with `status`.
  void Failed(const grpc::Status& status, TimePoint now);
  // The coordinator has answered that this worker cannot join now, for the reason in `status`.
  void Postponed(const grpc::Status& status, TimePoint now);
  // A call has succeeded.
  void Ended();

 private:
  void Begin(TimePoint now);
  void Log(const char* event, const std::string& reason, TimePoint now);

  const Endpoint endpoint_;
  std::optional<TimePoint> since_;  // the first failure of this outage
  TimePoint next_;                  // when the next check is due
  std::chrono::seconds interval_{};
  std::optional<ReachabilityCheck> check_;
};

}  // namespace tessera
