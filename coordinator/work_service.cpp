#include "coordinator/work_service.h"

#include <cmath>

#include "coordinator/core_thread.h"
#include "wire/channel.h"
#include "wire/convert.h"

namespace tessera {
namespace {

constexpr double kRenderSecondsMax = 1e6;  // a measurement beyond it is nonsense

// A call that waits for news. Its break is the news that the worker is gone.
class SynchronizeCall final : public grpc::ServerUnaryReactor {
 public:
  SynchronizeCall(CoreThread& core, CallId id) : core_(core), id_(id) {}

 private:
  void OnCancel() override {
    core_.Post([id = id_](CoreContext& context) {
      const auto answer = context.answers.TakeDirective(id);
      if (!answer) return;
      context.farm.Cut(context.now, id);
      answer(nullptr);
    });
  }
  void OnDone() override { delete this; }

  CoreThread& core_;
  CallId id_;
};

Result<std::vector<ReturnedUnit>> ReadResults(const proto::ResultsRequest& request) {
  if (request.worker() == 0) return BadInput("message refused: worker is missing");
  if (request.results_size() > kResultsPerCallMax) return BadInput("message refused: results are too many");
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

grpc::ServerUnaryReactor* WorkService::Synchronize(grpc::CallbackServerContext* context,
                                                   const proto::WorkerState* request,
                                                   proto::WorkerDirective* answer) {
  auto state = ReadWorkerState(*request);
  if (!state) {
    grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
    reactor->Finish(ToStatus(state.error()));
    return reactor;
  }
  const CallId id{call_next_++};
  auto* const call = new SynchronizeCall(core_, id);
  core_.Post([call, id, answer, state = std::move(*state)](CoreContext& core) {
    if (const auto admitted = core.farm.CheckAdmission(state); !admitted) {
      call->Finish(ToStatus(admitted.error()));
      return;
    }
    core.answers.AwaitDirective(id, [call, answer](const WorkerDirective* directive) {
      if (directive != nullptr) Write(*directive, *answer);
      call->Finish(directive != nullptr ? grpc::Status::OK : CoordinatorEnds());
    });
    core.farm.Synchronize(core.now, id, state);
  });
  return call;
}

grpc::ServerUnaryReactor* WorkService::ReturnResults(grpc::CallbackServerContext* context,
                                                     const proto::ResultsRequest* request,
                                                     proto::ResultsAnswer* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  bytes_in_ += request->ByteSizeLong();
  auto units = ReadResults(*request);  // here, so that checking and copying pixels uses many threads
  if (!units) {
    reactor->Finish(ToStatus(units.error()));
    return reactor;
  }
  const CallId id{call_next_++};
  const WorkerId worker{request->worker()};
  const auto shared = std::make_shared<std::vector<ReturnedUnit>>(std::move(*units));
  core_.Post([=](CoreContext& core) {
    core.answers.AwaitResults(id, [reactor, answer](const FarmOutput::Results* results) {
      if (results != nullptr) WriteResults(*results, *answer);
      reactor->Finish(results != nullptr ? grpc::Status::OK : CoordinatorEnds());
    });
    core.farm.ReturnResults(core.now, id, worker, std::move(*shared));
  });
  return reactor;
}

grpc::ServerUnaryReactor* WorkService::ReturnFailure(grpc::CallbackServerContext* context,
                                                     const proto::FailureRequest* request,
                                                     proto::FailureAnswer*) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  const WorkerId worker{request->worker()};
  const std::string words = ReadReason(request->reason());
  const auto finish = [reactor](bool synced) {
    reactor->Finish(synced ? grpc::Status::OK : CoordinatorEnds());
  };
  if (request->lease() != 0) {
    const auto unit = ReadWorkUnit(request->unit());
    if (!unit) {
      reactor->Finish(ToStatus(unit.error()));
      return reactor;
    }
    core_.Post([=, lease = LeaseId{request->lease()}](CoreContext& core) {
      core.farm.FailUnit(core.now, worker, lease, *unit, words);
      core.answers.AfterSync(finish);
    });
    return reactor;
  }
  const auto scene = ReadDigest(request->scene(), "scene");
  if (!scene) {
    reactor->Finish(ToStatus(scene.error()));
    return reactor;
  }
  core_.Post([=](CoreContext& core) {
    core.farm.FailScene(core.now, worker, *scene, words);
    core.answers.AfterSync(finish);
  });
  return reactor;
}

}  // namespace tessera
