#include "coordinator/web_calls.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coordinator/ask_core.h"
#include "coordinator/guarded.h"
#include "coordinator/missing_blobs.h"
#include "coordinator/submission.h"
#include "coordinator/web/api/routes.h"
#include "coordinator/web_upload.h"
#include "proto/shell/system.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr const CallRule* FindRule(std::string_view call) {
  for (const CallRule& rule : kCallRules) {
    if (rule.method == call) return &rule;
  }
  return nullptr;
}

// A route whose call has no rule does not compile.
static_assert(std::ranges::all_of(kWebRoutes, [](const WebRoute& route) { return FindRule(route.call); }));

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
  explicit WebCalls(WebCallParts parts) : parts_(std::move(parts)) {}

  std::optional<WebError> Admit(const WebCaller& caller, std::string_view call) const;
  WebReach Reach(const Visitor& visitor, std::string_view call) const;
  void AdmitToJob(const WebCaller& caller, std::string_view call, JobId job,
                  const WebDone<JobStatus>& done) const;
  void Detail(JobId job, uint32_t frame, const WebDone<JobDetail>& done) const;
  void ChangeJob(const WebCaller& caller, const JobChange& change, const WebDone<JobStatus>& done) const;
  void ChangeWorkers(const WebCaller& caller, std::string_view call, const std::string& which,
                     WebDone<std::vector<WorkerStatus>> done) const;
  WebResult<FrameState> Frame(JobId job, uint32_t frame) const;
  WebResult<JobLogPage> Log(JobId job, uint64_t after, size_t limit) const;
  WebResult<std::string> Read(JobId job, uint32_t frame, const std::optional<PictureFile>& file) const;
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
  // Applies a change, and answers when everything that it caused is on stable storage. The entry in the audit
  // log has these details.
  template <typename Value>
  void Apply(const Principal& caller, const CallRule& rule, const std::string& details,
             std::function<WebResult<Value>(CoreContext&)> change, WebDone<Value> done) const;
  Principal PrincipalOf(const WebCaller& caller) const;
  static WebResult<JobStatus> Change(CoreContext& core, const JobChange& change);
  CoreThread& core() const { return parts_.gate.core(); }

  const WebCallParts parts_;
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

template <typename Value>
void WebCalls::Apply(const Principal& caller, const CallRule& rule, const std::string& details,
                     std::function<WebResult<Value>(CoreContext&)> change, WebDone<Value> done) const {
  const auto finish = [=, &rule](WebResult<Value> result, const grpc::Status& status) {
    CallGate::Audit(caller, rule, details, status);
    done(std::move(result));
  };
  const auto fail = [finish](const grpc::Status& status) { finish(ErrorOf(status), status); };
  const ChangePath& path = parts_.gate.path();
  path.threads.Post([=, this, &path] {
    const auto space = GuardedResult([&] { return path.directory.CheckSpace(0); });
    if (!space)
      return fail(
          {grpc::StatusCode::UNAVAILABLE, "the coordinator cannot write its data: " + space.error().message});
    core().Post([=](CoreContext& context) {
      if (const std::string& reason = context.farm.storage_reason(); !reason.empty())
        return fail({grpc::StatusCode::UNAVAILABLE, "the coordinator cannot write its data: " + reason});
      WebResult<Value> changed = WebError{503, ""};
      const grpc::Status guarded = GuardedStatus([&] {
        changed = change(context);
        return grpc::Status::OK;
      });
      if (!guarded.ok()) changed = ErrorOf(guarded);
      if (const auto* const error = std::get_if<WebError>(&changed)) {
        const auto code = error->status == 403 ? grpc::StatusCode::PERMISSION_DENIED
                                               : grpc::StatusCode::FAILED_PRECONDITION;
        return finish(changed, {code, error->reason});
      }
      context.answers.AfterSync([finish, fail, changed](const Result<void>& synced) {
        if (synced) return finish(changed, grpc::Status::OK);
        fail({grpc::StatusCode::UNAVAILABLE,
              "the coordinator cannot write its data: " + synced.error().message +
                  "; the change takes effect when it can be written"});
      });
    });
  });
}

WebResult<JobStatus> WebCalls::Change(CoreContext& core, const JobChange& change) {
  Farm& farm = core.farm;
  const auto changed = [&]() -> Result<JobStatus> {
    if (change.call == "Jobs.Pause") return farm.SetPaused(core.now, change.job, true);
    if (change.call == "Jobs.Resume") return farm.SetPaused(core.now, change.job, false);
    if (change.call == "Jobs.Cancel") return farm.Cancel(core.now, change.job);
    if (change.call == "Jobs.Extend")
      return farm.Extend(core.now, change.job, static_cast<uint32_t>(change.value));
    TESSERA_CHECK(change.call == "Jobs.SetPriority");
    return farm.SetPriority(core.now, change.job, static_cast<int32_t>(change.value));
  }();
  if (!changed) return WebError{409, changed.error().message};
  return *changed;
}

void WebCalls::ChangeJob(const WebCaller& caller, const JobChange& change,
                         const WebDone<JobStatus>& done) const {
  const Principal principal = PrincipalOf(caller);
  const CallRule& rule = *FindRule(change.call);
  const bool is_extend = change.call == "Jobs.Extend", is_priority = change.call == "Jobs.SetPriority";
  if (is_extend && (change.value < 1 || change.value > int64_t{kSamplesPerPixelMax}))
    return done(WebError{400, "samples_per_pixel: out of range"});
  if (is_priority && (change.value < -kPriorityMax || change.value > kPriorityMax))
    return done(WebError{400, fmt::format("priority: expected {} to {}", -kPriorityMax, kPriorityMax)});
  std::string details = fmt::format("job={}", Number(change.job));
  if (is_extend) details += fmt::format(" samples_per_pixel={}", change.value);
  if (is_priority) details += fmt::format(" priority={}", change.value);
  const auto apply = [=, this, &rule] {
    const auto checked = [=, this, &rule](CoreContext& context) -> WebResult<JobStatus> {
      const grpc::Status admitted = parts_.gate.AdmitToJob(principal, rule, context, change.job);
      if (!admitted.ok()) return ErrorOf(admitted);
      if (is_extend && context.farm.IsMovingSums(change.job))
        return WebError{503, "a picture of the job is being written"};
      return Change(context, change);
    };
    Apply<JobStatus>(principal, rule, details, checked, done);
  };
  if (!is_extend) return apply();
  // Blobs may have been evicted since the job ended. Checking takes too long for the core thread.
  const auto check = [=, this](const JobSpec& spec) {
    const auto checked = GuardedResult([&] { return CheckSubmission(spec, parts_.blobs); });
    if (checked) return apply();
    done(checked.error().kind == ErrorKind::kInterrupted
             ? ErrorOf(TryAgain(checked.error().message))
             : WebError{409, checked.error().message + "; submit the scene again"});
  };
  core().Post([=, this, &rule](CoreContext& context) {
    const grpc::Status admitted = GuardedStatus([&] {
      const grpc::Status may = parts_.gate.AdmitToJob(principal, rule, context, change.job);
      if (!may.ok()) return may;
      const auto spec = context.farm.Spec(change.job);
      PostCheck(parts_.files, parts_.blobs, spec->package, [check, spec] { check(*spec); });
      return grpc::Status::OK;
    });
    if (!admitted.ok()) done(ErrorOf(admitted));
  });
}

void WebCalls::ChangeWorkers(const WebCaller& caller, std::string_view call, const std::string& which,
                             WebDone<std::vector<WorkerStatus>> done) const {
  using Workers = std::vector<WorkerStatus>;
  const auto change = [call, which](CoreContext& context) -> WebResult<Workers> {
    for (const WorkerStatus& worker : context.farm.FindWorkers(context.now, which)) {
      if (call == "Jobs.DrainWorkers") {
        context.farm.Drain(worker.worker);
      } else {
        context.farm.Release(worker.worker);
      }
    }
    Workers changed = context.farm.FindWorkers(context.now, which);
    if (changed.empty()) return WebError{404, fmt::format("there is no worker {}", which)};
    return changed;
  };
  Apply<Workers>(PrincipalOf(caller), *FindRule(call), fmt::format("worker={}", LogText(which)), change,
                 std::move(done));
}

WebResult<FrameState> WebCalls::Frame(JobId job, uint32_t frame) const {
  using Clock = std::chrono::steady_clock;
  auto state = AskCore(core(), [job, frame](CoreContext& context) -> std::optional<FrameState> {
    const auto start = Clock::now();
    const auto status = context.farm.Status(context.now, job);
    if (!status || frame >= status->frames_total) return std::nullopt;
    FrameState found{*status, context.farm.Spec(job), {}, context.farm.FinishedFile(job, frame), {}};
    if (!found.file) {
      if (auto preview = context.farm.Preview(job, frame)) found.snapshot = std::move(preview->snapshot);
    }
    found.cost = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start);
    return found;
  });
  if (!state) return WebError{503, "the coordinator is busy"};
  if (!*state) return WebError{404, fmt::format("there is no frame {} of job {}", frame, Number(job))};
  return std::move(**state);
}

WebResult<JobLogPage> WebCalls::Log(JobId job, uint64_t after, size_t limit) const {
  auto page = parts_.job_log.Read(job, after, limit);
  if (!page) return WebError{404, fmt::format("there is no job {}", Number(job))};
  return std::move(*page);
}

// What was damaged since it was written is not shown. It is made again if that is possible.
WebResult<std::string> WebCalls::Read(JobId job, uint32_t frame,
                                      const std::optional<PictureFile>& file) const {
  if (!file) {
    auto partial = GuardedResult([&] { return parts_.pictures.ReadPartial(job, frame); });
    if (partial) return std::move(*partial);
    return WebError{409, fmt::format("nothing was rendered of frame {} of job {}", frame, Number(job))};
  }
  auto bytes = GuardedResult([&] { return parts_.pictures.Read(job, frame, *file); });
  const FrameId id{job, frame};
  if (bytes) {
    core().Post([id](CoreContext& context) { context.farm.PictureIntact(id); });
    return std::move(*bytes);
  }
  core().Post([id, reason = bytes.error().message](CoreContext& context) {
    context.farm.PictureDamaged(id, reason);
  });
  return WebError{503, bytes.error().message + "; it is made again if that is possible"};
}

// The files of the package may have to be read.
void WebCalls::OrderJob(const WebCaller& caller, JobOrder order, const WebDone<JobStatus>& done) const {
  const Principal principal = PrincipalOf(caller);
  const CallRule& rule = *FindRule("Jobs.Submit");
  if (order.submission == 0) order.submission = RandomId();
  order.name = CleanName(order.name.empty() ? order.scene.scene_file : order.name);
  const auto shared = std::make_shared<const JobOrder>(std::move(order));
  parts_.files.lengthy.Post([=, this, &rule] {
    const auto checked = GuardedResult([&] { return CheckOrder(shared->scene, parts_.blobs); });
    if (!checked) {
      const auto& [kind, message] = checked.error();
      if (kind == ErrorKind::kInterrupted) return done(ErrorOf(TryAgain(message)));
      return done(WebError{kind == ErrorKind::kBadInput ? 400 : 409, message});
    }
    const auto submit = [=](CoreContext& context) -> WebResult<JobStatus> {
      const auto job = context.farm.Order(context.now, shared, principal.Owner());
      if (!job) return WebError{job.error().kind == ErrorKind::kBadInput ? 400 : 503, job.error().message};
      return *context.farm.Status(context.now, *job);
    };
    Apply<JobStatus>(principal, rule, fmt::format("name={}", LogText(shared->name)), submit, done);
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
  farm.look = parts.look;
  farm.folder = parts.folder;
  farm.run_later = [&background = parts.background](std::function<void()> task) {
    background.Post(std::move(task));
  };
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
  farm.change_workers = [calls](const auto& caller, auto call, const auto& which, auto done) {
    calls->ChangeWorkers(caller, call, which, std::move(done));
  };
  farm.frame = [calls](JobId job, uint32_t frame) { return calls->Frame(job, frame); };
  farm.log = [calls](JobId job, uint64_t after, size_t limit) { return calls->Log(job, after, limit); };
  farm.read = [calls](JobId job, uint32_t frame, const auto& file) { return calls->Read(job, frame, file); };
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
