// The way of every call into the coordinator: the caller is identified, its rule is checked (access.h), then
// its handler runs.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <functional>
#include <utility>

#include "coordinator/access.h"
#include "coordinator/core_thread.h"
#include "coordinator/guarded.h"
#include "coordinator/message_guard.h"
#include "coordinator/open_calls.h"
#include "coordinator/store/data_dir.h"
#include "coordinator/task_pool.h"
#include "proto/identity/subject.h"
#include "proto/shell/rare_log.h"
#include "proto/wire/channel.h"

namespace tessera {

// What handlers use to make changes that survive a crash.
struct ChangePath {
  CoreThread& core;
  TaskPool& threads;  // for looks at the disk
  const DataDir& directory;
};

class CallGate;

// A call with one answer that was admitted, of gRPC or of the web interface. Copies refer to the same call,
// which one of them has to finish, once, from any thread. Request and answer of the call live until then.
class UnaryCall {
 public:
  // `finish` sends the answer, or the error, to the caller.
  UnaryCall(const CallGate& gate, const CallRule& rule, Principal caller,
            std::function<void(const grpc::Status&)> finish)
      : gate_(&gate),
        rule_(&rule),
        caller_(std::move(caller)),
        finish_(std::move(finish)),
        details_(rule.effect == Effect::kChanges ? std::make_shared<std::string>() : nullptr) {}
  const Principal& caller() const { return caller_; }
  CoreThread& core() const;

  // See CallGate::AdmitToJob.
  grpc::Status AdmitToJob(const CoreContext& core, JobId job) const;
  grpc::Status AdmitToWorker(const CoreContext& core, WorkerId worker) const;

  // What a call that changes something is about, for its entry in the audit log: "job=3".
  void Note(std::string details) const {
    if (details_) *details_ = std::move(details);
  }

  void Finish(const grpc::Status& status) const;

  // Runs `query`, a grpc::Status(CoreContext&) that changes nothing, on the core thread and finishes with
  // what it returns.
  template <typename Query>
  void Ask(Query query) const {
    core().Post([call = *this, query = std::move(query)](CoreContext& core) {
      call.Finish(GuardedStatus([&] { return query(core); }));
    });
  }

  // Runs `change`, a grpc::Status(CoreContext&), on the core thread. Finishes with its error, or, when
  // everything that it caused is on stable storage, with OK. If the disk takes nothing, or fewer than `bytes`
  // besides the usual, nothing is changed and the call finishes with that reason, unless the call frees
  // space. If that shows only while the change is written, the call finishes with the reason as well, and the
  // change is written later, followed by what `undo` does.
  template <typename Change>
  void Apply(Change change, uint64_t bytes = 0, CoreThread::Event undo = {}) const {
    path().threads.Post([call = *this, bytes, change = std::move(change), undo = std::move(undo)] {
      const grpc::Status posted = GuardedStatus([&] {
        const auto space = call.path().directory.CheckSpace(bytes);
        if (!space && !call.rule_->frees_space) return DiskFails(space.error().message);
        call.core().Post([call, change, undo](CoreContext& core) {
          const grpc::Status status = GuardedStatus([&] { return call.Make(change, undo, core); });
          if (!status.ok()) call.Finish(status);
        });
        return grpc::Status::OK;
      });
      if (!posted.ok()) call.Finish(posted);
    });
  }

 private:
  const ChangePath& path() const;
  // Makes the change, whose call then finishes when it is stored. Returns why it is not made.
  template <typename Change>
  grpc::Status Make(const Change& change, const CoreThread::Event& undo, CoreContext& core) const {
    const auto& reason = core.farm.storage_reason();
    if (!reason.empty() && !rule_->frees_space) return DiskFails(reason);
    if (const grpc::Status status = change(core); !status.ok()) return status;
    core.answers.AfterSync([call = *this, undo](const Result<void>& synced) {
      if (synced || !undo) return call.Finish(Stored(synced));
      // Everybody sees what is undone before the caller can try again.
      call.core().Post([call, undo, stored = Stored(synced)](CoreContext& later) {
        undo(later);
        later.answers.AfterSync([call, stored](const Result<void>&) { call.Finish(stored); });
      });
    });
    return grpc::Status::OK;
  }
  static grpc::Status DiskFails(const std::string& reason);
  static grpc::Status Stored(const Result<void>& synced);

  const CallGate* gate_;
  const CallRule* rule_;
  Principal caller_;
  std::function<void(const grpc::Status&)> finish_;
  std::shared_ptr<std::string> details_;  // null if the call changes nothing
};

// Admits calls and runs their handlers. Thread safe. Every method of every service is one call of Unary or
// Serve.
class CallGate {
 public:
  // Called for each call from a member or the holder of a token, with the address of its connection.
  using OnIdentified = std::function<void(std::string_view peer)>;
  // `farm` is the one that the core thread runs. Calls that are meant for another are refused.
  CallGate(const ChangePath& path, FarmId farm, AccessPolicy policy, OnIdentified on_identified = {})
      : path_(path),
        farm_(farm),
        policy_(std::move(policy)),
        on_identified_(std::move(on_identified)),
        open_calls_(core().members(), [this](const Principal& caller) { return Recheck(caller); }) {}
  const ChangePath& path() const { return path_; }
  CoreThread& core() const { return path_.core; }
  FarmId farm() const { return farm_; }

  // A call with one answer. `handler`, a void(const UnaryCall&), runs on gRPC's thread and must not block. If
  // it throws, it has not finished the call and has not passed it on.
  template <typename Handler>
  grpc::ServerUnaryReactor* Unary(grpc::CallbackServerContext* context, const CallRule& rule,
                                  Handler handler) const {
    grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
    Principal caller;
    if (const grpc::Status admitted = Admit(*context, rule, caller); !admitted.ok()) {
      reactor->Finish(Shortened(admitted));
    } else {
      const UnaryCall call(*this, rule, std::move(caller),
                           [reactor](const grpc::Status& status) { reactor->Finish(Shortened(status)); });
      const grpc::Status passed_on = GuardedStatus([&] {
        handler(call);
        return grpc::Status::OK;
      });
      if (!passed_on.ok()) call.Finish(passed_on);
    }
    return reactor;
  }

  // Any other call, such as a stream: `make`, a Reactor*(LastingCall), returns its reactor. It keeps the
  // argument until it is done, or asks Recheck itself several times per second.
  template <typename Reactor, typename Make>
  Reactor* Serve(grpc::CallbackServerContext* context, const CallRule& rule, Make make) const {
    Principal caller;
    if (const grpc::Status admitted = Admit(*context, rule, caller); !admitted.ok())
      return new RefusedCall<Reactor>(admitted);
    return make(LastingCall(*context, std::move(caller), open_calls_));
  }

  // Whether an admitted caller may make the call for this job: NOT_FOUND if there is none, PERMISSION_DENIED,
  // which is logged, if the job has another owner.
  grpc::Status AdmitToJob(const Principal& caller, const CallRule& rule, const CoreContext& core,
                          JobId job) const;

  // Sets `caller` to the holder of a certificate, `pem`, with this URI, which was checked. UNAUTHENTICATED if
  // that cannot be told or holds no longer.
  grpc::Status IdentifyHolder(std::string_view uri, std::string_view pem, Principal& caller) const;

  // Whether an admitted caller may make the call for this worker process: UNAVAILABLE if it has not joined,
  // PERMISSION_DENIED, which is logged, if it is another member's.
  grpc::Status AdmitToWorker(const Principal& caller, const CallRule& rule, const CoreContext& core,
                             WorkerId worker) const;
  // The same for a worker that is about to join.
  grpc::Status AdmitJoin(const Principal& caller, const CallRule& rule, const CoreContext& core,
                         WorkerId worker) const;

  // The entry of a call in the audit log: who made it, from where, what it was about and what came of it.
  // Omitted for calls that were denied, which have an entry already. `details`: fields of a log line.
  static void Audit(const Principal& caller, const CallRule& rule, const std::string& details,
                    const grpc::Status& status);
  // The same for calls that a member can make as often as it likes: of those that failed, kFailuresLogged in
  // an interval have an entry and the others are counted in `failed`.
  static void Audit(const Principal& caller, const CallRule& rule, const std::string& details,
                    const grpc::Status& status, RareLog& failed);
  static constexpr std::chrono::seconds kLogInterval{10};
  static constexpr int kFailuresLogged = 100;
  RareLog& failed() const { return failed_; }
  // PERMISSION_DENIED with this reason, which is logged.
  grpc::Status Deny(const Principal& caller, const CallRule& rule, const std::string& reason) const;

  // UNAUTHENTICATED if the certificate of the caller has expired or was revoked.
  grpc::Status Recheck(const Principal& caller) const;

 private:
  // Denials that are logged one by one in an interval; whoever was let in once can cause any number.
  static constexpr int kDenialsLogged = 100;

  // Sets `caller` to whoever makes the call. UNAUTHENTICATED if that cannot be told or holds no longer,
  // PERMISSION_DENIED if the policy does not admit the caller. Both are logged.
  grpc::Status Admit(const grpc::CallbackServerContext& context, const CallRule& rule,
                     Principal& caller) const;
  grpc::Status Identify(const grpc::CallbackServerContext& context, Principal& caller) const;
  grpc::Status IdentifyMember(MemberId id, Principal& caller) const;
  // Whoever has a certificate of an organisation, in PEM form, is listed as a member from the first call on.
  grpc::Status IdentifyOfOrganisation(const Subject& subject, std::string_view pem, Principal& caller) const;
  void LogDenial(const Principal& caller, const CallRule& rule, const grpc::Status& status) const;

  const ChangePath path_;
  const FarmId farm_;
  const AccessPolicy policy_;
  const OnIdentified on_identified_;
  mutable OpenCalls open_calls_;
  mutable RareLog denied_{kLogInterval, kDenialsLogged};
  mutable RareLog failed_{kLogInterval, kFailuresLogged};
};

}  // namespace tessera
