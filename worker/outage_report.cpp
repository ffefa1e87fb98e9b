#include "worker/outage_report.h"

#include <grpcpp/support/status.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "renderer/text/unicode.h"

namespace tessera {

void OutageReport::Begin(TimePoint now) {
  if (since_) return;
  since_ = now;
  next_ = now + kOutageReportFirst;
  interval_ = kOutageReportFirst;
}

void OutageReport::Failed(const grpc::Status& status, TimePoint now) {
  Begin(now);
  if (check_) {
    const auto found = check_->Await({});
    if (!found) return;
    check_.reset();
    return Log("coordinator_unreachable", DescribeOutage(*found, status), now);
  }
  if (now >= next_) check_.emplace(endpoint_);
}

void OutageReport::Postponed(const grpc::Status& status, TimePoint now) {
  Begin(now);
  check_.reset();
  if (now == *since_ || now >= next_) Log("join_postponed", status.error_message(), now);
}

void OutageReport::Log(const char* event, const std::string& reason, TimePoint now) {
  interval_ = std::min<std::chrono::seconds>(interval_ * kOutageReportGrowth, kOutageReportIntervalMax);
  next_ = now + interval_;
  spdlog::warn("{} address={} reason={} outage_s={:.0f} next_report_s={}", event, endpoint_.address.Text(),
               LogText(reason), std::chrono::duration<double>(now - *since_).count(), interval_.count());
}

void OutageReport::Ended() {
  since_.reset();
  check_.reset();
}

}  // namespace tessera
