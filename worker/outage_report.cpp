#include "worker/outage_report.h"

#include <grpcpp/support/status.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "renderer/text/unicode.h"

namespace tessera {

void OutageReport::Failed(const grpc::Status& status, TimePoint now) {
  if (!since_) {
    since_ = now;
    next_ = now + kOutageReportFirst;
    interval_ = kOutageReportFirst;
  }
  if (check_) {
    const auto found = check_->Await({});
    if (!found) return;
    check_.reset();
    return Log(*found, status, now);
  }
  if (now >= next_) check_.emplace(address_);
}

void OutageReport::Log(const Reachability& found, const grpc::Status& status, TimePoint now) {
  interval_ = std::min<std::chrono::seconds>(interval_ * kOutageReportGrowth, kOutageReportIntervalMax);
  next_ = now + interval_;
  spdlog::warn("coordinator_unreachable address={} reason={} outage_s={:.0f} next_report_s={}",
               address_.Text(), LogText(DescribeOutage(found, status)),
               std::chrono::duration<double>(now - *since_).count(), interval_.count());
}

void OutageReport::Ended() {
  since_.reset();
  check_.reset();
}

}  // namespace tessera
