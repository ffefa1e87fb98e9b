#include "worker/returner.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <spdlog/spdlog.h>

#include "proto/shell/backoff.h"
#include "proto/shell/pause.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "proto/work.grpc.pb.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kAnswerPatience{60};  // results are written to disk before they are answered

std::vector<Lease> ReadLeases(const google::protobuf::RepeatedPtrField<proto::Lease>& messages) {
  std::vector<Lease> leases;
  for (const proto::Lease& message : messages) {
    const auto lease = ReadLease(message);
    if (lease) leases.push_back(*lease);  // one that makes no sense lapses
  }
  return leases;
}

std::vector<LeaseId> ReadIds(const google::protobuf::RepeatedField<uint64_t>& numbers) {
  std::vector<LeaseId> ids;
  for (const uint64_t number : numbers) ids.push_back(LeaseId{number});
  return ids;
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
    spdlog::debug("answered unit=\"{}\" verdict={}", unit.Text(), NameOf(answer.verdicts(i)));
    if (answer.verdicts(i) != proto::ResultsAnswer::REFUSED) continue;
    const std::string words = reason < answer.reasons_size() ? ReadReason(answer.reasons(reason)) : "";
    ++reason;
    spdlog::error("result_refused unit=\"{}\" reason=\"{}\"", unit.Text(), words);
  }
}

// One conversation of the returner: a stub and a way to stop.
class Courier {
 public:
  Courier(const std::shared_ptr<grpc::Channel>& channel, WorkerId worker, Workbench& bench,
          std::stop_token stop)
      : stub_(proto::Work::NewStub(channel)), worker_(worker), bench_(bench), stop_(std::move(stop)) {}

  grpc::Status Send(const std::vector<FinishedUnit>& results) {
    proto::ResultsRequest request;
    for (const FinishedUnit& result : results) {
      proto::UnitResult& message = *request.add_results();
      message.set_lease(Number(result.lease));
      Write(result.unit, *message.mutable_unit());
      message.set_tile(result.tile);
      message.set_render_seconds(result.render_seconds);
    }
    proto::ResultsAnswer answer;
    const grpc::Status status = Call([&](grpc::ClientContext* context) {
      const auto writer = stub_->ReturnResults(context, &answer);
      if (writer->Write(Announcement(worker_, request))) writer->WriteLast(request, {});
      return writer->Finish();
    });
    if (!status.ok()) return status;
    LogVerdicts(answer, results);
    bench_.AddLeases(ReadLeases(answer.leases()), ReadIds(answer.drop()));
    bench_.ResultsAnswered(results);
    return status;
  }

  grpc::Status Send(const FailureReport& failure) {
    proto::FailureRequest request;
    request.set_worker(Number(worker_));
    request.set_lease(Number(failure.lease));
    if (failure.lease != LeaseId{}) Write(failure.unit, *request.mutable_unit());
    request.set_scene(WriteDigest(failure.scene));
    request.set_reason(ReadReason(failure.reason));
    proto::FailureAnswer answer;
    const grpc::Status status =
        Call([&](grpc::ClientContext* context) { return stub_->ReturnFailure(context, request, &answer); });
    if (!status.ok()) return status;
    bench_.AddLeases(ReadLeases(answer.leases()), {});
    bench_.FailureAnswered();
    return status;
  }

 private:
  template <typename Method>
  grpc::Status Call(Method method) {
    grpc::ClientContext context;
    SetDeadline(context, kAnswerPatience);
    const std::stop_callback on_stop(stop_, [&context] { context.TryCancel(); });
    return method(&context);
  }

  std::unique_ptr<proto::Work::Stub> stub_;
  WorkerId worker_;
  Workbench& bench_;
  std::stop_token stop_;
};

}  // namespace

void Returner::Run(std::stop_token stop) {
  Courier courier(channel_, worker_, bench_, stop);
  Backoff backoff(Number(worker_) + 1);  // not in step with the synchronizer's
  size_t batch_bytes = kResultsBatchBytes;
  while (true) {
    const Workbench::Parcel parcel = bench_.AwaitParcel(batch_bytes, stop);
    if (stop.stop_requested() || std::holds_alternative<std::monostate>(parcel)) return;
    const auto* results = std::get_if<std::vector<FinishedUnit>>(&parcel);
    const grpc::Status status =
        results != nullptr ? courier.Send(*results) : courier.Send(std::get<FailureReport>(parcel));
    if (status.ok()) {
      backoff.Reset();
      batch_bytes = kResultsBatchBytes;
      continue;
    }
    if (status.error_code() == grpc::StatusCode::FAILED_PRECONDITION) {
      on_refusal_(ToError(status, "return results"));
      return;
    }
    batch_bytes = 0;  // one at a time: the batch may have been too large, or one of it bad
    if (status.error_code() == grpc::StatusCode::INVALID_ARGUMENT &&
        (results == nullptr || results->size() == 1)) {
      spdlog::error("result_unreturnable reason=\"{}\"", status.error_message());
      if (results != nullptr) {
        bench_.ResultsAnswered(*results);  // the lease lapses
      } else {
        bench_.FailureAnswered();
      }
      continue;
    }
    if (!Pause(stop, backoff.Next())) return;
  }
}

}  // namespace tessera
