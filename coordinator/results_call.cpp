#include "coordinator/results_call.h"

#include <fmt/format.h>

#include <cmath>

#include "coordinator/call_gate.h"
#include "coordinator/core/tile_request.h"
#include "coordinator/guarded.h"
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

// The tile of a result as its open job wants it.
Result<RadianceTile> ReadTile(const OpenJobs& jobs, const WorkUnit& unit, const std::string& bytes,
                              uint64_t& decoded_bytes_left) {
  const auto job = jobs.Find(unit.job);
  if (job == nullptr) return Failed("there is no such open job");
  const auto request = RequestOf(*job, unit);
  if (!request) return request.error();
  const uint64_t decoded_bytes = DecodedSize(request->bounds, request->shape, bytes.size());
  if (decoded_bytes > decoded_bytes_left) return Failed("the tile is larger than announced");
  decoded_bytes_left -= decoded_bytes;
  return DecodeRadianceTile(bytes, *request);
}

Result<std::vector<ReturnedUnit>> ReadResults(const OpenJobs& jobs, const proto::ResultsRequest& request,
                                              FarmId farm, uint64_t decoded_bytes_max) {
  if (request.results_size() > kResultsPerCallMax)
    return BadInput(
        fmt::format("message refused: too many results in one call (limit {})", kResultsPerCallMax));
  std::vector<ReturnedUnit> units;
  for (const proto::UnitResult& result : request.results()) {
    const auto unit = ReadWorkUnit(result.unit());
    if (!unit) return unit.error();
    const double seconds = result.render_seconds();
    const bool is_sane = std::isfinite(seconds) && seconds >= 0 && seconds <= kRenderSecondsMax;
    units.push_back({ReadLeaseId(result.lease()), *unit, is_sane ? seconds : 0,
                     ReadTile(jobs, *unit, result.tile(), decoded_bytes_max), farm});
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
  for (const std::string& reason : results.reasons) answer.add_reasons(CleanReason(reason));
  for (const Lease& lease : results.grants.leases) Write(lease, *answer.add_leases());
  for (const LeaseId lease : results.grants.drop) Write(lease, *answer.add_drop());
  answer.set_farm(WriteFarmId(results.farm));
}

// Of a Unix socket, all connections have the same name.
std::string SenderOf(const std::string& peer, WorkerId worker) {
  return peer.starts_with("unix:") ? fmt::format("{} {}", peer, Number(worker)) : peer;
}

}  // namespace

ResultsCall::ResultsCall(const CallGate& gate, ResultsIntake& intake, LastingCall call, CallId id,
                         proto::ResultsAnswer& answer, std::atomic<uint64_t>& bytes_in)
    : gate_(gate),
      intake_(intake),
      call_(std::move(call)),
      canceller_(std::make_shared<Canceller>()),
      id_(id),
      answer_(answer),
      bytes_in_(bytes_in) {
  canceller_->context = &call_.context();
  StartRead(&received_);
}

void ResultsCall::OnReadDone(bool ok) {
  if (!ok) {
    return Finish(Refusal(bytes_ == 0 ? "the announcement is missing" : "the announced results are missing"));
  }
  const grpc::Status read = GuardedStatus([this] { return Read(); });
  if (!read.ok()) Finish(Shortened(read));
}

// Returns an error unless the call goes on.
grpc::Status ResultsCall::Read() {
  bytes_in_ += received_.Length();
  if (bytes_ > 0 && received_.Length() > bytes_) return Refusal("the results are larger than announced");
  proto::ResultsRequest request;
  const auto parsed = ParseMessage(received_, RuleFor("Work.ReturnResults").limits, request);
  if (!parsed.ok()) return parsed;
  return bytes_ == 0 ? Announced(request) : Received(request);
}

grpc::Status ResultsCall::Announced(const proto::ResultsRequest& announcement) {
  if (announcement.worker() == 0) return Refusal("worker is missing");
  if (announcement.bytes() == 0) return Refusal("bytes is missing");
  if (announcement.bytes() > static_cast<uint64_t>(kMessageBytesMax))
    return {grpc::StatusCode::RESOURCE_EXHAUSTED, "the results are larger than the message limit"};
  if (announcement.decoded_bytes() > kIntakeBytesMax - static_cast<uint64_t>(kMessageBytesMax))
    return {grpc::StatusCode::RESOURCE_EXHAUSTED, "the results are larger than the room for results"};
  const auto farm = ReadFarmId(announcement.farm());
  if (!farm) return ToStatus(farm.error());
  worker_ = WorkerId{announcement.worker()};
  farm_ = *farm;
  bytes_ = announcement.bytes();
  decoded_bytes_ = announcement.decoded_bytes();
  const auto admitted = [this] {
    admitted_ = true;
    StartRead(&received_);
  };
  // The call may be over by then.
  const auto expired = [canceller = canceller_] {
    const std::lock_guard lock(canceller->mutex);
    if (canceller->context != nullptr) canceller->context->TryCancel();
  };
  intake_.Enter({id_, SenderOf(call_.caller().peer, worker_), bytes_ + decoded_bytes_, admitted, expired});
  return grpc::Status::OK;
}

// Decodes here rather than on the core thread, so that checking and copying pixels uses many threads.
grpc::Status ResultsCall::Received(const proto::ResultsRequest& results) {
  intake_.Arrived(id_);
  auto units = ReadResults(gate_.core().open_jobs(), results, farm_, decoded_bytes_);
  if (!units) return ToStatus(units.error());
  intake_.Shrink(id_, decoded_bytes_);
  const auto shared = std::make_shared<std::vector<ReturnedUnit>>(std::move(*units));
  gate_.core().Post([this, shared](CoreContext& core) {
    const grpc::Status passed_on = GuardedStatus([&] { return PassOn(core, std::move(*shared)); });
    if (passed_on.ok()) return;
    core.answers.DropResults(id_);
    Finish(Shortened(passed_on));
  });
  return grpc::Status::OK;
}

// The core answers the call unless an error is returned.
grpc::Status ResultsCall::PassOn(CoreContext& core, std::vector<ReturnedUnit> units) {
  const grpc::Status admitted =
      gate_.AdmitToWorker(call_.caller(), RuleFor("Work.ReturnResults"), core, worker_);
  if (!admitted.ok()) return admitted;
  core.answers.AwaitResults(id_, [this](const FarmOutput::Results* answer) { Answer(answer); });
  core.farm.ReturnResults(core.now, id_, worker_, std::move(units));
  return grpc::Status::OK;
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
  {
    const std::lock_guard lock(canceller_->mutex);
    canceller_->context = nullptr;
  }
  if (admitted_) intake_.Leave(id_);
  delete this;
}

}  // namespace tessera
