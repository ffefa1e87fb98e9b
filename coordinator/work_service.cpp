#include "coordinator/work_service.h"

#include "coordinator/call_gate.h"
#include "coordinator/guarded.h"
#include "coordinator/results_call.h"
#include "coordinator/submission.h"
#include "proto/shell/pause.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kExpiryInterval{250};

// Older workers do not say, and what newer ones may say is not known.
FailureCause CauseOf(const proto::FailureRequest& request) {
  return request.cause() == proto::FailureRequest::WORKER_LIMIT ? FailureCause::kWorkerLimit
                                                                : FailureCause::kScene;
}

// A call that waits for news. If it is cancelled, the worker is gone.
class SynchronizeCall final : public grpc::ServerUnaryReactor {
 public:
  SynchronizeCall(CoreThread& core, CallId id, LastingCall call)
      : core_(core), id_(id), call_(std::move(call)) {}
  const Principal& caller() const { return call_.caller(); }

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
  const LastingCall call_;
};

}  // namespace

grpc::Status CheckJoin(const Farm& farm, const WorkerState& state) {
  if (const auto admitted = farm.CheckAdmission(state); !admitted) return ToStatus(admitted.error());
  if (const std::string why = farm.WhyNoPlace(state.worker); !why.empty())
    return {grpc::StatusCode::RESOURCE_EXHAUSTED, why};
  return grpc::Status::OK;
}

WorkService::WorkService(const CallGate& gate) : gate_(gate) {
  const auto serve = [this](auto method, const CallRule& rule) {
    MarkMethodCallback(MethodIndex(rule), GuardedMethod(this, rule, method));
  };
  serve(&WorkService::Synchronize, RuleFor("Work.Synchronize"));
  serve(&WorkService::ReturnResults, RuleFor("Work.ReturnResults"));
  serve(&WorkService::ReturnFailure, RuleFor("Work.ReturnFailure"));
  serve(&WorkService::ReturnPreparation, RuleFor("Work.ReturnPreparation"));
  expiry_ = std::jthread([this](std::stop_token stop) { ExpireAnnouncements(std::move(stop)); });
}

void WorkService::ExpireAnnouncements(std::stop_token stop) {
  while (Pause(stop, kExpiryInterval)) intake_.Expire(ResultsIntake::Clock::now());
}

grpc::ServerUnaryReactor* WorkService::Synchronize(grpc::CallbackServerContext* context,
                                                   const proto::WorkerState* request,
                                                   proto::WorkerDirective* answer) {
  using Reactor = grpc::ServerUnaryReactor;
  return gate_.Serve<Reactor>(context, RuleFor("Work.Synchronize"), [=, this](LastingCall lasting) {
    CoreThread& thread = gate_.core();
    const CallId id{call_next_++};
    auto* const call = new SynchronizeCall(thread, id, std::move(lasting));
    auto state = ReadWorkerState(*request);
    if (!state) {
      call->Finish(ToStatus(state.error()));
      return call;
    }
    const Principal& caller = call->caller();
    state->member = caller.member;
    if (caller.member != MemberId{}) state->name = caller.name;
    thread.Post([=, this, state = std::move(*state)](CoreContext& core) {
      const grpc::Status passed_on = GuardedStatus([&] {
        const grpc::Status admitted =
            gate_.AdmitJoin(call->caller(), RuleFor("Work.Synchronize"), core, state.worker);
        if (!admitted.ok()) return admitted;
        if (const grpc::Status may_join = CheckJoin(core.farm, state); !may_join.ok()) return may_join;
        core.answers.AwaitDirective(id, [call, answer](const WorkerDirective* directive) {
          if (directive != nullptr) Write(*directive, *answer);
          call->Finish(directive != nullptr ? grpc::Status::OK : CoordinatorEnds());
        });
        core.farm.Synchronize(core.now, id, state);
        return grpc::Status::OK;
      });
      if (passed_on.ok()) return;
      core.answers.TakeDirective(id);
      call->Finish(Shortened(passed_on));
    });
    return call;
  });
}

grpc::ServerReadReactor<grpc::ByteBuffer>* WorkService::ReturnResults(grpc::CallbackServerContext* context,
                                                                      proto::ResultsAnswer* answer) {
  using Reactor = grpc::ServerReadReactor<grpc::ByteBuffer>;
  return gate_.Serve<Reactor>(context, RuleFor("Work.ReturnResults"), [=, this](LastingCall call) {
    return new ResultsCall(gate_, intake_, std::move(call), CallId{call_next_++}, *answer, bytes_in_);
  });
}

grpc::ServerUnaryReactor* WorkService::ReturnFailure(grpc::CallbackServerContext* context,
                                                     const proto::FailureRequest* request,
                                                     proto::FailureAnswer* answer) {
  return gate_.Unary(context, RuleFor("Work.ReturnFailure"), [=](const UnaryCall& call) {
    const WorkerId worker{request->worker()};
    const std::string reason = CleanReason(request->reason());
    const auto farm = ReadFarmId(request->farm());
    if (!farm) return call.Finish(ToStatus(farm.error()));
    // A failure of another farm is answered, so that the worker forgets it.
    const auto apply = [=, farm = *farm](CoreContext& core, const auto& fail) -> grpc::Status {
      if (const grpc::Status admitted = call.AdmitToWorker(core, worker); !admitted.ok()) return admitted;
      answer->set_farm(WriteFarmId(core.farm.id()));
      if (farm == core.farm.id()) fail();
      return grpc::Status::OK;
    };
    if (request->has_lease()) {
      const auto unit = ReadWorkUnit(request->unit());
      if (!unit) return call.Finish(ToStatus(unit.error()));
      return call.Apply([=, unit = *unit, lease = ReadLeaseId(request->lease())](CoreContext& core) {
        return apply(core, [&] { core.farm.FailUnit(worker, lease, unit, reason); });
      });
    }
    const auto scene = ReadDigest(request->scene(), "scene");
    if (!scene) return call.Finish(ToStatus(scene.error()));
    const FailureCause cause = CauseOf(*request);
    call.Apply([=, scene = *scene](CoreContext& core) {
      return apply(core, [&] { core.farm.FailScene(worker, scene, reason, cause); });
    });
  });
}

grpc::ServerUnaryReactor* WorkService::ReturnPreparation(grpc::CallbackServerContext* context,
                                                         const proto::PreparationReport* request,
                                                         proto::PreparationAnswer*) {
  return gate_.Unary(context, RuleFor("Work.ReturnPreparation"), [=](const UnaryCall& call) {
    auto read = ReadPreparationReport(*request);
    if (!read) return call.Finish(ToStatus(read.error()));
    if (const auto checked = CheckFrames(read->frames); !checked) {
      read->frames.clear();
      read->reason = CleanReason(checked.error().message);
    }
    const auto report = std::make_shared<const PreparationReport>(std::move(*read));
    // A report of another farm is answered, so that the worker forgets it.
    call.Apply(
        [=, worker = WorkerId{request->worker()}](CoreContext& core) -> grpc::Status {
          if (const grpc::Status admitted = call.AdmitToWorker(core, worker); !admitted.ok()) return admitted;
          if (report->farm == core.farm.id()) core.farm.ReturnPreparation(core.now, worker, *report);
          return grpc::Status::OK;
        },
        request->ByteSizeLong());
  });
}

}  // namespace tessera
