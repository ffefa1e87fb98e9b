#include "coordinator/results_call.h"

#include <fmt/format.h>

#include <cmath>

#include "coordinator/core_thread.h"
#include "coordinator/message_guard.h"
#include "coordinator/results_intake.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"

namespace tessera {
namespace {

constexpr double kRenderSecondsMax = 1e6;  // no measurement is longer

grpc::Status Refusal(const char* what) {
  return ToStatus(BadInput(std::string("message refused: ") + what));
}

Result<std::vector<ReturnedUnit>> ReadResults(const proto::ResultsRequest& request) {
  if (request.results_size() > kResultsPerCallMax)
    return BadInput(
        fmt::format("message refused: too many results in one call (limit {})", kResultsPerCallMax));
  std::vector<ReturnedUnit> units;
  for (const proto::UnitResult& result : request.results()) {
    const auto unit = ReadWorkUnit(result.unit());
    if (!unit) return unit.error();
    const double seconds = result.render_seconds();
    const bool is_sane = std::isfinite(seconds) && seconds >= 0 && seconds <= kRenderSecondsMax;
    units.push_back(
        {LeaseId{result.lease()}, *unit, is_sane ? seconds : 0, DecodeRadianceTile(result.tile())});
  }
  return units;
}

proto::ResultsAnswer::Verdict WriteVerdict(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAccepted: return proto::ResultsAnswer::ACCEPTED;
    case Verdict::kDuplicate: return proto::ResultsAnswer::DUPLICATE;
    case Verdict::kObsolete: return proto::ResultsAnswer::OBSOLETE;
    case Verdict::kRefused: return proto::ResultsAnswer::REFUSED;
  }
  TESSERA_CHECK(false);
}

void WriteResults(const FarmOutput::Results& results, proto::ResultsAnswer& answer) {
  for (const Verdict verdict : results.verdicts) answer.add_verdicts(WriteVerdict(verdict));
  for (const std::string& reason : results.reasons) answer.add_reasons(reason);
  for (const Lease& lease : results.grants.leases) Write(lease, *answer.add_leases());
  for (const LeaseId lease : results.grants.drop) answer.add_drop(Number(lease));
}

}  // namespace

ResultsCall::ResultsCall(CoreThread& core, ResultsIntake& intake, CallId id, proto::ResultsAnswer& answer,
                         std::atomic<uint64_t>& bytes_in)
    : core_(core), intake_(intake), id_(id), answer_(answer), bytes_in_(bytes_in) {
  StartRead(&received_);
}

void ResultsCall::OnReadDone(bool ok) {
  if (!ok) {
    return Finish(Refusal(bytes_ == 0 ? "the announcement is missing" : "the announced results are missing"));
  }
  bytes_in_ += received_.Length();
  if (bytes_ > 0 && received_.Length() > bytes_)
    return Finish(Refusal("the results are larger than announced"));
  proto::ResultsRequest request;
  const auto parsed = ParseMessage(received_, RuleFor("Work.ReturnResults").limits, request);
  if (!parsed.ok()) return Finish(parsed);
  if (bytes_ == 0) {
    Announced(request);
  } else {
    Received(request);
  }
}

void ResultsCall::Announced(const proto::ResultsRequest& announcement) {
  if (announcement.worker() == 0) return Finish(Refusal("worker is missing"));
  if (announcement.bytes() == 0) return Finish(Refusal("bytes is missing"));
  if (announcement.bytes() > static_cast<uint64_t>(kMessageBytesMax))
    return Finish({grpc::StatusCode::RESOURCE_EXHAUSTED, "the results are larger than the message limit"});
  worker_ = WorkerId{announcement.worker()};
  bytes_ = announcement.bytes();
  intake_.Enter(id_, bytes_, [this] {
    admitted_ = true;
    StartRead(&received_);
  });
}

// Decodes here rather than on the core thread, so that checking and copying pixels uses many threads.
void ResultsCall::Received(const proto::ResultsRequest& results) {
  auto units = ReadResults(results);
  if (!units) return Finish(ToStatus(units.error()));
  const auto shared = std::make_shared<std::vector<ReturnedUnit>>(std::move(*units));
  core_.Post([this, shared](CoreContext& core) {
    core.answers.AwaitResults(id_, [this](const FarmOutput::Results* answer) { Answer(answer); });
    core.farm.ReturnResults(core.now, id_, worker_, std::move(*shared));
  });
}

void ResultsCall::Answer(const FarmOutput::Results* results) {
  if (results != nullptr) WriteResults(*results, answer_);
  Finish(results != nullptr ? grpc::Status::OK : CoordinatorEnds());
}

// While a call waits for admission, no read is open that would report the cancellation.
void ResultsCall::OnCancel() {
  if (intake_.Withdraw(id_)) Finish(grpc::Status::CANCELLED);
}

void ResultsCall::OnDone() {
  if (admitted_) intake_.Leave(bytes_);
  delete this;
}

}  // namespace tessera
