#include "worker/result_sender.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <spdlog/spdlog.h>

#include "proto/shell/backoff.h"
#include "proto/shell/pause.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "proto/work.grpc.pb.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// Results are written to disk before they are acknowledged.
constexpr std::chrono::seconds kResultsPatience{60};

std::vector<Lease> ReadLeases(const google::protobuf::RepeatedPtrField<proto::Lease>& messages) {
  std::vector<Lease> leases;
  for (const proto::Lease& message : messages) {
    const auto lease = ReadLease(message);
    // A malformed lease is left to expire.
    if (lease) leases.push_back(*lease);
  }
  return leases;
}

std::vector<LeaseId> ReadIds(const google::protobuf::RepeatedPtrField<proto::LeaseId>& messages) {
  std::vector<LeaseId> ids;
  for (const proto::LeaseId& message : messages) ids.push_back(ReadLeaseId(message));
  return ids;
}

// No farm if it is malformed: what comes with it is ignored then.
FarmId FarmOf(const std::string& bytes) {
  const auto farm = ReadFarmId(bytes);
  return farm ? *farm : FarmId{};
}

const char* NameOf(int verdict) {
  switch (verdict) {
    case proto::ResultsAnswer::ACCEPTED: return "accepted";
    case proto::ResultsAnswer::DUPLICATE: return "duplicate";
    case proto::ResultsAnswer::OBSOLETE: return "obsolete";
    default: return "refused";
  }
}

void LogVerdicts(const proto::ResultsAnswer& answer, const std::vector<FinishedUnit>& results) {
  int reason = 0;
  for (int i = 0; i < answer.verdicts_size() && i < static_cast<int>(results.size()); ++i) {
    const WorkUnit& unit = results[static_cast<size_t>(i)].unit;
    spdlog::debug("result_answered farm={} unit={} verdict={}", results[static_cast<size_t>(i)].farm.Hex(),
                  LogText(unit.Text()), NameOf(answer.verdicts(i)));
    if (answer.verdicts(i) != proto::ResultsAnswer::REFUSED) continue;
    const std::string why = reason < answer.reasons_size() ? CleanReason(answer.reasons(reason)) : "";
    ++reason;
    spdlog::error("result_refused unit={} reason={}", LogText(unit.Text()), LogText(why));
  }
}

// The calls that send results, failures and reports.
class Calls {
 public:
  Calls(const std::shared_ptr<grpc::Channel>& channel, WorkerId worker, SharedWorkload& workload,
        std::stop_token stop)
      : stub_(proto::Work::NewStub(channel)), worker_(worker), workload_(workload), stop_(std::move(stop)) {}

  grpc::Status Send(const std::vector<FinishedUnit>& results) {
    const FarmId farm = results.front().farm;
    proto::ResultsRequest request;
    for (const FinishedUnit& result : results) {
      proto::UnitResult& message = *request.add_results();
      Write(result.lease, *message.mutable_lease());
      Write(result.unit, *message.mutable_unit());
      message.set_tile(result.tile);
      message.set_render_seconds(result.render_seconds);
    }
    proto::ResultsAnswer answer;
    const grpc::Status status = Call([&](grpc::ClientContext* context) {
      const auto writer = stub_->ReturnResults(context, &answer);
      if (writer->Write(Announcement(worker_, farm, request))) writer->WriteLast(request, {});
      return writer->Finish();
    });
    if (!status.ok()) return status;
    LogVerdicts(answer, results);
    workload_.Change()->AddLeases(FarmOf(answer.farm()), ReadLeases(answer.leases()), ReadIds(answer.drop()),
                                  SharedWorkload::Clock::now());
    workload_.Change()->ResultsAnswered(results);
    return status;
  }

  grpc::Status Send(const FailureReport& failure) {
    proto::FailureRequest request;
    request.set_worker(Number(worker_));
    request.set_farm(WriteFarmId(failure.farm));
    if (failure.lease != LeaseId{}) {
      Write(failure.lease, *request.mutable_lease());
      Write(failure.unit, *request.mutable_unit());
    }
    request.set_scene(WriteDigest(failure.scene));
    request.set_reason(CleanReason(failure.reason));
    if (failure.cause == FailureCause::kWorkerLimit) request.set_cause(proto::FailureRequest::WORKER_LIMIT);
    proto::FailureAnswer answer;
    const grpc::Status status =
        Call([&](grpc::ClientContext* context) { return stub_->ReturnFailure(context, request, &answer); });
    if (!status.ok()) return status;
    workload_.Change()->AddLeases(FarmOf(answer.farm()), ReadLeases(answer.leases()), {},
                                  SharedWorkload::Clock::now());
    workload_.Change()->FailureAnswered(failure);
    return status;
  }

  grpc::Status Send(const PreparationQueue::Report& report) {
    proto::PreparationReport request;
    Write(*report, request);
    request.set_worker(Number(worker_));
    proto::PreparationAnswer answer;
    const grpc::Status status = Call(
        [&](grpc::ClientContext* context) { return stub_->ReturnPreparation(context, request, &answer); });
    if (status.ok()) workload_.Change()->PreparationAnswered(*report);
    return status;
  }

 private:
  template <typename Method>
  grpc::Status Call(Method method) {
    grpc::ClientContext context;
    SetDeadline(context, kResultsPatience);
    const std::stop_callback on_stop(stop_, [&context] { context.TryCancel(); });
    return method(&context);
  }

  std::unique_ptr<proto::Work::Stub> stub_;
  WorkerId worker_;
  SharedWorkload& workload_;
  std::stop_token stop_;
};

}  // namespace

void ResultSender::Run(std::stop_token stop) {
  Calls calls(channel_, worker_, workload_, stop);
  // Another seed than the synchronizer's, so that their attempts do not coincide.
  Backoff backoff(Number(worker_) + 1);
  size_t batch_bytes = kResultsBatchBytes;
  while (true) {
    const Workload::Batch batch = workload_.AwaitBatch(batch_bytes, stop);
    if (stop.stop_requested() || std::holds_alternative<std::monostate>(batch)) return;
    const auto* results = std::get_if<std::vector<FinishedUnit>>(&batch);
    const auto* report = std::get_if<PreparationQueue::Report>(&batch);
    const grpc::Status status = results != nullptr  ? calls.Send(*results)
                                : report != nullptr ? calls.Send(*report)
                                                    : calls.Send(std::get<FailureReport>(batch));
    if (status.ok()) {
      backoff.Reset();
      batch_bytes = kResultsBatchBytes;
      continue;
    }
    // One at a time: the batch may have been too large, or one result of it malformed.
    batch_bytes = 0;
    if (status.error_code() == grpc::StatusCode::INVALID_ARGUMENT &&
        (results == nullptr || results->size() == 1)) {
      spdlog::error("result_not_accepted reason={}", LogText(status.error_message()));
      if (results != nullptr) {
        workload_.Change()->ResultsAnswered(*results);  // the lease expires
      } else if (report != nullptr) {
        workload_.Change()->PreparationRefused(**report,
                                               "its frames were not accepted: " + status.error_message());
      } else {
        workload_.Change()->FailureAnswered(std::get<FailureReport>(batch));
      }
      continue;
    }
    // The coordinator was reached and refused a batch that nothing is wrong with: it is tried again after
    // others.
    if (!IsTransient(status)) workload_.Change()->Postpone(batch);
    if (!Pause(stop, backoff.Next())) return;
  }
}

}  // namespace tessera
