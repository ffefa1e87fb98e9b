#include "coordinator/web_calls.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coordinator/guarded.h"
#include "coordinator/job_changes.h"
#include "coordinator/missing_blobs.h"
#include "coordinator/submission.h"
#include "coordinator/web/api/routes.h"
#include "coordinator/web_pictures.h"
#include "coordinator/web_upload.h"
#include "coordinator/worker_changes.h"
#include "proto/shell/system.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr bool HasRoute(const JobChangeKind& change) {
  return std::ranges::any_of(kWebRoutes, [&](const WebRoute& route) {
    return route.call == change.call && route.action == WebAction::kChangeJob &&
           route.parameters == change.argument;
  });
}
constexpr bool HasRoute(const WorkerChangeKind& change) {
  return std::ranges::any_of(kWebRoutes, [&](const WebRoute& route) {
    return route.call == change.call && route.action == WebAction::kChangeWorkers;
  });
}
constexpr bool HasHandler(const WebRoute& route) {
  return (route.action == WebAction::kChangeJob) == (FindJobChange(route.call) != nullptr) &&
         (route.action == WebAction::kChangeWorkers) == (FindWorkerChange(route.call) != nullptr);
}
static_assert(std::ranges::all_of(kWebRoutes, [](const WebRoute& route) { return FindRule(route.call); }),
              "the call of a route has no rule in access.h");
static_assert(std::ranges::all_of(kJobChanges, [](const auto& change) { return HasRoute(change); }),
              "a change of jobs has no route with its argument as its parameter");
static_assert(std::ranges::all_of(kWorkerChanges, [](const auto& change) { return HasRoute(change); }),
              "a change of workers has no route");
static_assert(
    std::ranges::all_of(kWebRoutes, HasHandler),
    "a route makes a change that is in neither kJobChanges nor kWorkerChanges, or has another action");

WebError ErrorOf(const grpc::Status& status) {
  const auto code = [&] {
    switch (status.error_code()) {
      case grpc::StatusCode::NOT_FOUND: return 404;
      case grpc::StatusCode::PERMISSION_DENIED: return 403;
      case grpc::StatusCode::UNAUTHENTICATED: return 401;
      case grpc::StatusCode::INVALID_ARGUMENT: return 400;
      case grpc::StatusCode::FAILED_PRECONDITION: return 409;
      default: return 503;
    }
  };
  return {code(), status.error_message()};
}

class WebCalls {
 public:
  explicit WebCalls(WebCallParts parts) : parts_(std::move(parts)), changes_(parts_.blobs, parts_.files) {}

  std::optional<WebError> Admit(const WebCaller& caller, std::string_view call) const;
  WebReach Reach(const Visitor& visitor, std::string_view call) const;
  void AdmitToJob(const WebCaller& caller, std::string_view call, JobId job,
                  const WebDone<JobStatus>& done) const;
  void Detail(JobId job, uint32_t frame, const WebDone<JobDetail>& done) const;
  void ChangeJob(const WebCaller& caller, const JobChange& change, const WebDone<JobStatus>& done) const;
  void ChangeWorkers(const WebCaller& caller, std::string_view name, const std::string& which,
                     const WebDone<std::vector<WorkerStatus>>& done) const;
  WebResult<JobLogPage> Log(JobId job, uint64_t after, size_t limit) const;
  void OrderJob(const WebCaller& caller, JobOrder order, const WebDone<JobStatus>& done) const;
  void FindMissing(const std::vector<Digest>& digests, const WebDone<std::map<Digest, uint64_t>>& done) const;
  std::shared_ptr<BodySink> ReceiveBlob(const WebCaller& caller, const Digest& digest, uint64_t size,
                                        uint64_t offset) const {
    return MakeWebUpload({parts_.blobs, parts_.files, parts_.transfers}, PrincipalOf(caller), digest, size,
                         offset);
  }

 private:
  // Gives what `query`, a WebResult<Value>(CoreContext&) that changes nothing, returns on the core thread.
  template <typename Value, typename Query>
  void Ask(Query query, WebDone<Value> done) const;
  // A call that changes something, and what it gives to `done` when it has finished with OK.
  template <typename Value>
  std::pair<UnaryCall, std::shared_ptr<Value>> Begin(const WebCaller& caller, const CallRule& rule,
                                                     const WebDone<Value>& done) const;
  Principal PrincipalOf(const WebCaller& caller) const;
  CoreThread& core() const { return parts_.gate.core(); }

  const WebCallParts parts_;
  const JobChanges changes_;
};

template <typename Value, typename Query>
void WebCalls::Ask(Query query, WebDone<Value> done) const {
  core().Post([query = std::move(query), done = std::move(done)](CoreContext& context) {
    const grpc::Status guarded = GuardedStatus([&] {
      done(query(context));
      return grpc::Status::OK;
    });
    if (!guarded.ok()) done(ErrorOf(guarded));
  });
}

template <typename Value>
std::pair<UnaryCall, std::shared_ptr<Value>> WebCalls::Begin(const WebCaller& caller, const CallRule& rule,
                                                             const WebDone<Value>& done) const {
  auto value = std::make_shared<Value>();
  const auto finish = [value, done](const grpc::Status& status) {
    if (!status.ok()) return done(ErrorOf(status));
    done(std::move(*value));
  };
  return {UnaryCall(parts_.gate, rule, PrincipalOf(caller), finish), value};
}

// Programs of other users of this machine have no role.
Principal WebCalls::PrincipalOf(const WebCaller& caller) const {
  Principal principal;
  principal.member = caller.visitor.member;
  principal.name = caller.visitor.name;
  principal.peer = caller.peer;
  principal.role = FindRole(caller.visitor.role);
  if (!principal.role && parts_.is_insecure) {
    principal.role = Role::kOperator;
    principal.name = kLocalOwner;
  }
  return principal;
}

std::optional<WebError> WebCalls::Admit(const WebCaller& caller, std::string_view call) const {
  const CallRule& rule = *FindRule(call);
  const Principal principal = PrincipalOf(caller);
  if (!principal.role) {
    if (rule.permission == Permission::kView) return std::nullopt;
    return ErrorOf(parts_.gate.Deny(principal, rule,
                                    "programs of other users of this machine may only look at the farm"));
  }
  const auto admitted = parts_.policy(principal, rule);
  if (admitted) return std::nullopt;
  return ErrorOf(parts_.gate.Deny(principal, rule, admitted.error().message));
}

WebReach WebCalls::Reach(const Visitor& visitor, std::string_view call) const {
  const Principal principal = PrincipalOf({visitor, ""});
  if (!principal.role) return WebReach::kNothing;
  switch (ReachOf(principal.role, FindRule(call)->permission)) {
    case tessera::Reach::kNothing: return WebReach::kNothing;
    case tessera::Reach::kOwn: return WebReach::kOwn;
    case tessera::Reach::kEverything: return WebReach::kEverything;
  }
  return WebReach::kNothing;
}

void WebCalls::AdmitToJob(const WebCaller& caller, std::string_view call, JobId job,
                          const WebDone<JobStatus>& done) const {
  const auto admit = [=, this,
                      principal = PrincipalOf(caller)](CoreContext& context) -> WebResult<JobStatus> {
    const grpc::Status admitted = parts_.gate.AdmitToJob(principal, *FindRule(call), context, job);
    if (!admitted.ok()) return ErrorOf(admitted);
    return *context.farm.Status(context.now, job);
  };
  Ask<JobStatus>(admit, done);
}

void WebCalls::Detail(JobId job, uint32_t frame, const WebDone<JobDetail>& done) const {
  const auto find = [=](CoreContext& context) -> WebResult<JobDetail> {
    const auto status = context.farm.Status(context.now, job);
    if (!status) return WebError{404, fmt::format("there is no job {}", Number(job))};
    JobDetail detail{*status, context.farm.Spec(job), context.farm.Frames(job), {}};
    const LeaseTable& leases = context.farm.scheduler().leases();
    for (const LeaseId id : leases.OfJob(job)) {
      const LeaseRecord& record = leases.At(id);
      if (record.lease.unit.frame != frame) continue;
      if (detail.units.size() == kUnitsShownMax) break;
      detail.units.push_back(
          {record.lease.bounds, record.lease.unit.range, record.worker, !record.IsWaiting(context.now)});
    }
    return detail;
  };
  Ask<JobDetail>(find, done);
}

void WebCalls::ChangeJob(const WebCaller& caller, const JobChange& change,
                         const WebDone<JobStatus>& done) const {
  const auto [call, status] = Begin(caller, *FindRule(change.call), done);
  changes_.Make(call, *FindJobChange(change.call), change.job, change.value,
                [status = status](const Result<JobStatus>& changed) -> grpc::Status {
                  if (!changed) return {grpc::StatusCode::FAILED_PRECONDITION, changed.error().message};
                  *status = *changed;
                  return grpc::Status::OK;
                });
}

void WebCalls::ChangeWorkers(const WebCaller& caller, std::string_view name, const std::string& which,
                             const WebDone<std::vector<WorkerStatus>>& done) const {
  const auto [call, workers] = Begin(caller, *FindRule(name), done);
  tessera::ChangeWorkers(call, *FindWorkerChange(name), which,
                         [workers = workers](const auto& changed) { *workers = changed; });
}

WebResult<JobLogPage> WebCalls::Log(JobId job, uint64_t after, size_t limit) const {
  auto page = parts_.job_log.Read(job, after, limit);
  if (!page) return WebError{404, fmt::format("there is no job {}", Number(job))};
  return std::move(*page);
}

// The files of the package may have to be read.
void WebCalls::OrderJob(const WebCaller& caller, JobOrder order, const WebDone<JobStatus>& done) const {
  const auto [call, status] = Begin(caller, RuleFor("Jobs.Submit"), done);
  if (order.submission == 0) order.submission = RandomId();
  order.name = CleanName(order.name.empty() ? order.scene.scene_file : order.name);
  call.Note(fmt::format("name={}", LogText(order.name)));
  const auto shared = std::make_shared<const JobOrder>(std::move(order));
  parts_.files.lengthy.Post([=, this, call = call, status = status] {
    const auto checked = GuardedResult([&] { return CheckOrder(shared->scene, parts_.blobs); });
    if (!checked) return call.Finish(NotRenderable(checked.error()));
    call.Apply([=](CoreContext& context) -> grpc::Status {
      const auto job = context.farm.Order(context.now, shared, call.caller().Owner());
      if (!job) return NotAdmitted(job.error());
      *status = *context.farm.Status(context.now, *job);
      return grpc::Status::OK;
    });
  });
}

void WebCalls::FindMissing(const std::vector<Digest>& digests,
                           const WebDone<std::map<Digest, uint64_t>>& done) const {
  const auto find = [=, this] {
    auto found = GuardedResult([&] { return tessera::FindMissing(parts_.blobs, digests); });
    if (!found) return done(WebError{503, found.error().message});
    done(std::move(*found));
  };
  parts_.files.brief.Post(
      [=, this] { IsQuickToFind(parts_.blobs, digests) ? find() : parts_.files.lengthy.Post(find); });
}

}  // namespace

WebFarm MakeWebFarm(WebCallParts parts) {
  WebFarm farm;
  farm.view = parts.view;
  farm.keep = [&directory = parts.gate.path().directory](std::string_view bytes) {
    return directory.KeepForSending(bytes);
  };
  farm.run_later = [&background = parts.background](std::function<void()> task) {
    background.Post(std::move(task));
  };
  const WebPictures pictures(parts.gate.core(), parts.pictures);
  const auto calls = std::make_shared<const WebCalls>(std::move(parts));
  farm.admit = [calls](const auto& caller, auto call) { return calls->Admit(caller, call); };
  farm.reach = [calls](const auto& visitor, auto call) { return calls->Reach(visitor, call); };
  farm.admit_to_job = [calls](const auto& caller, auto call, JobId job, const auto& done) {
    calls->AdmitToJob(caller, call, job, done);
  };
  farm.detail = [calls](JobId job, uint32_t frame, const auto& done) { calls->Detail(job, frame, done); };
  farm.change_job = [calls](const auto& caller, const auto& change, const auto& done) {
    calls->ChangeJob(caller, change, done);
  };
  farm.change_workers = [calls](const auto& caller, auto call, const auto& which, const auto& done) {
    calls->ChangeWorkers(caller, call, which, done);
  };
  farm.frame = [pictures](JobId job, uint32_t frame) { return pictures.Frame(job, frame); };
  farm.log = [calls](JobId job, uint64_t after, size_t limit) { return calls->Log(job, after, limit); };
  farm.read = [pictures](JobId job, uint32_t frame, const auto& file) {
    return pictures.Read(job, frame, file);
  };
  farm.open = [pictures](JobId job, uint32_t frame, const auto& file) {
    return pictures.Open(job, frame, file);
  };
  farm.order_job = [calls](const auto& caller, const auto& order, const auto& done) {
    calls->OrderJob(caller, order, done);
  };
  farm.find_missing = [calls](const auto& digests, const auto& done) { calls->FindMissing(digests, done); };
  farm.receive_blob = [calls](const auto& caller, const Digest& digest, uint64_t size, uint64_t offset) {
    return calls->ReceiveBlob(caller, digest, size, offset);
  };
  return farm;
}

}  // namespace tessera
