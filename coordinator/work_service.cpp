#include "coordinator/work_service.h"

#include "coordinator/core_thread.h"
#include "coordinator/results_call.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"

namespace tessera {
namespace {

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

grpc::ServerReadReactor<proto::ResultsRequest>* WorkService::ReturnResults(grpc::CallbackServerContext*,
                                                                           proto::ResultsAnswer* answer) {
  return new ResultsCall(core_, intake_, CallId{call_next_++}, *answer, bytes_in_);
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
