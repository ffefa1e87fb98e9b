// The way of every call into the coordinator: its rule is checked (access.h), then its handler runs.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <functional>
#include <utility>

#include "coordinator/access.h"
#include "coordinator/core_thread.h"
#include "coordinator/guarded.h"
#include "coordinator/message_guard.h"
#include "proto/wire/channel.h"

namespace tessera {

// A unary call that was admitted. Copies refer to the same call, which one of them has to finish, once, from
// any thread. Request and answer of the call live until then.
class UnaryCall {
 public:
  UnaryCall(CoreThread& core, Principal caller, grpc::ServerUnaryReactor* reactor)
      : core_(&core), caller_(std::move(caller)), reactor_(reactor) {}
  const Principal& caller() const { return caller_; }
  CoreThread& core() const { return *core_; }

  void Finish(const grpc::Status& status) const { reactor_->Finish(Shortened(status)); }

  // Runs `query`, a grpc::Status(CoreContext&) that changes nothing, on the core thread and finishes with
  // what it returns.
  template <typename Query>
  void Ask(Query query) const {
    core_->Post([call = *this, query = std::move(query)](CoreContext& core) {
      call.Finish(GuardedStatus([&] { return query(core); }));
    });
  }

  // Runs `change`, a grpc::Status(CoreContext&), on the core thread. Finishes with its error, or, when
  // everything that it caused is on stable storage, with OK.
  template <typename Change>
  void Apply(Change change) const {
    core_->Post([call = *this, change = std::move(change)](CoreContext& core) {
      const grpc::Status status = change(core);
      if (!status.ok()) return call.Finish(status);
      core.answers.AfterSync(
          [call](bool synced) { call.Finish(synced ? grpc::Status::OK : CoordinatorEnds()); });
    });
  }

 private:
  CoreThread* core_;
  Principal caller_;
  grpc::ServerUnaryReactor* reactor_;
};

// Admits calls and runs their handlers. Thread safe. Every method of every service is one call of Unary or
// Serve.
class CallGate {
 public:
  // `farm` is the one that the core thread runs. Calls that are meant for another are refused.
  CallGate(CoreThread& core, FarmId farm, AccessPolicy policy)
      : core_(core), farm_(farm), policy_(std::move(policy)) {}
  CoreThread& core() const { return core_; }
  FarmId farm() const { return farm_; }

  // A call with one answer. `handler`, a void(const UnaryCall&), runs on gRPC's thread and must not block. If
  // it throws, it has not finished the call and has not passed it on.
  template <typename Handler>
  grpc::ServerUnaryReactor* Unary(grpc::CallbackServerContext* context, const CallRule& rule,
                                  Handler handler) const {
    grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
    Principal caller = CallerOf(*context);
    if (const grpc::Status admitted = Check(*context, caller, rule); !admitted.ok()) {
      reactor->Finish(admitted);
    } else {
      const UnaryCall call(core_, std::move(caller), reactor);
      const grpc::Status passed_on = GuardedStatus([&] {
        handler(call);
        return grpc::Status::OK;
      });
      if (!passed_on.ok()) call.Finish(passed_on);
    }
    return reactor;
  }

  // Any other call, such as a stream: `make`, a Reactor*(const Principal&), returns its reactor.
  template <typename Reactor, typename Make>
  Reactor* Serve(grpc::CallbackServerContext* context, const CallRule& rule, Make make) const {
    const Principal caller = CallerOf(*context);
    if (const grpc::Status admitted = Check(*context, caller, rule); !admitted.ok())
      return new RefusedCall<Reactor>(admitted);
    return make(caller);
  }

 private:
  static Principal CallerOf(const grpc::CallbackServerContext& context);
  grpc::Status Check(const grpc::CallbackServerContext& context, const Principal& caller,
                     const CallRule& rule) const;

  CoreThread& core_;
  const FarmId farm_;
  const AccessPolicy policy_;
};

}  // namespace tessera
