#include "coordinator/jobs_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <string_view>

#include "coordinator/answer_limit.h"
#include "coordinator/call_gate.h"
#include "coordinator/guarded.h"
#include "coordinator/job_log.h"
#include "coordinator/submission.h"
#include "coordinator/task_pool.h"
#include "coordinator/watch_stream.h"
#include "coordinator/worker_changes.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// The list of workers, or the last ones that fit into an answer.
void Write(const std::vector<WorkerStatus>& workers, proto::WorkersAnswer& answer) {
  for (const WorkerStatus& worker : workers) Write(worker, *answer.add_workers());
  answer.set_left_out(KeepLast(*answer.mutable_workers()));
}

grpc::Status NoJob(JobId job) {
  return {grpc::StatusCode::NOT_FOUND, fmt::format("there is no job {}", Number(job))};
}

Result<std::shared_ptr<const JobSpec>> ReadShared(const proto::JobSpec& request) {
  auto spec = ReadJobSpec(request);
  if (!spec) return spec.error();
  return std::make_shared<const JobSpec>(std::move(*spec));
}

// The handler of a change. `ValueOf` gets the new value from a request.
template <typename Request, auto ValueOf>
grpc::internal::MethodHandler* HandlerOf(const CallGate& gate, const JobChanges& changes,
                                         const JobChangeKind& change) {
  const CallRule& rule = *FindRule(change.call);
  return GuardedUnary<Request, proto::JobStatus>(
      rule, [&](grpc::CallbackServerContext* context, const Request* request, proto::JobStatus* answer) {
        return gate.Unary(context, rule, [&, request, answer](const UnaryCall& call) {
          changes.Make(call, change, JobId{request->job()}, std::invoke(ValueOf, *request),
                       [answer](const Result<JobStatus>& changed) {
                         if (!changed) return ToStatus(changed.error());
                         Write(*changed, *answer);
                         return grpc::Status::OK;
                       });
        });
      });
}

// What the calls that change jobs have as requests.
struct JobChangeCall {
  std::string_view call;
  grpc::internal::MethodHandler* (*handler)(const CallGate&, const JobChanges&, const JobChangeKind&);
};

constexpr auto kNoValue = [](const proto::JobRequest&) { return 0; };

constexpr JobChangeCall kJobChangeCalls[] = {
    {"Jobs.Pause", HandlerOf<proto::JobRequest, kNoValue>},
    {"Jobs.Resume", HandlerOf<proto::JobRequest, kNoValue>},
    {"Jobs.Cancel", HandlerOf<proto::JobRequest, kNoValue>},
    {"Jobs.SetPriority", HandlerOf<proto::PriorityRequest, &proto::PriorityRequest::priority>},
    {"Jobs.Extend", HandlerOf<proto::ExtendRequest, &proto::ExtendRequest::samples_per_pixel>},
};

constexpr const JobChangeCall* FindCall(const JobChangeKind& change) {
  const auto* const found = std::ranges::find(kJobChangeCalls, change.call, &JobChangeCall::call);
  return found != std::end(kJobChangeCalls) ? found : nullptr;
}
static_assert(std::ranges::all_of(kJobChanges, FindCall), "a change of jobs has no row in kJobChangeCalls");

grpc::internal::MethodHandler* HandlerOf(const CallGate& gate, const WorkerChangeKind& change) {
  const CallRule& rule = *FindRule(change.call);
  return GuardedUnary<proto::WorkersRequest, proto::WorkersAnswer>(
      rule, [&](grpc::CallbackServerContext* context, const proto::WorkersRequest* request,
                proto::WorkersAnswer* answer) {
        return gate.Unary(context, rule, [&, request, answer](const UnaryCall& call) {
          ChangeWorkers(call, change, CleanName(request->which()),
                        [answer](const std::vector<WorkerStatus>& changed) { Write(changed, *answer); });
        });
      });
}

}  // namespace

JobsService::JobsService(const CallGate& gate, const BlobStore& blobs, const PictureStore& pictures,
                         const class JobLog& log, FileThreads& threads)
    : gate_(gate),
      blobs_(blobs),
      log_(log),
      threads_(threads),
      changes_(blobs, threads),
      pictures_(gate, pictures, threads.brief) {
  const auto serve = [this](auto method, const CallRule& rule) {
    MarkMethodCallback(MethodIndex(rule), GuardedMethod(this, rule, method));
  };
  serve(&JobsService::Submit, RuleFor("Jobs.Submit"));
  serve(&JobsService::List, RuleFor("Jobs.List"));
  serve(&JobsService::Status, RuleFor("Jobs.Status"));
  serve(&JobsService::Watch, RuleFor("Jobs.Watch"));
  serve(&JobsService::Workers, RuleFor("Jobs.Workers"));
  serve(&JobsService::Frames, RuleFor("Jobs.Frames"));
  serve(&JobsService::FetchPicture, RuleFor("Jobs.FetchPicture"));
  serve(&JobsService::JobLog, RuleFor("Jobs.JobLog"));
  serve(&JobsService::Health, RuleFor("Jobs.Health"));
  ServeChanges();
}

void JobsService::ServeChanges() {
  for (const JobChangeKind& change : kJobChanges) {
    const CallRule& rule = *FindRule(change.call);
    MarkMethodCallback(MethodIndex(rule), FindCall(change)->handler(gate_, changes_, change));
  }
  for (const WorkerChangeKind& change : kWorkerChanges) {
    const CallRule& rule = *FindRule(change.call);
    MarkMethodCallback(MethodIndex(rule), HandlerOf(gate_, change));
  }
}

grpc::ServerUnaryReactor* JobsService::Submit(grpc::CallbackServerContext* context,
                                              const proto::JobSpec* request, proto::SubmitAnswer* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Submit"), [=, this](const UnaryCall& call) {
    threads_.brief.Post([=, this] {
      const auto read = GuardedResult([&] { return ReadShared(*request); });
      if (!read) return call.Finish(ToStatus(read.error()));
      PostCheck(threads_, blobs_, (*read)->package, [=, this, spec = *read] {
        const auto checked = GuardedResult([&] { return CheckSubmission(*spec, blobs_); });
        if (!checked) return call.Finish(NotRenderable(checked.error()));
        const auto submit = [=](CoreContext& core) {
          const auto job = core.farm.Submit(core.now, spec, call.caller().Owner());
          if (!job) return NotAdmitted(job.error());
          answer->set_job(Number(*job));
          call.Note(fmt::format("job={} name={}", Number(*job), LogText(spec->name)));
          return grpc::Status::OK;
        };
        call.Apply(submit, request->ByteSizeLong());
      });
    });
  });
}

grpc::ServerUnaryReactor* JobsService::List(grpc::CallbackServerContext* context, const proto::ListRequest*,
                                            proto::ListAnswer* answer) {
  return gate_.Unary(context, RuleFor("Jobs.List"), [=](const UnaryCall& call) {
    call.Ask([=](CoreContext& core) {
      for (const JobStatus& status : core.farm.Jobs(core.now)) Write(status, *answer->add_jobs());
      answer->set_left_out(KeepLast(*answer->mutable_jobs()));
      return grpc::Status::OK;
    });
  });
}

grpc::ServerUnaryReactor* JobsService::Status(grpc::CallbackServerContext* context,
                                              const proto::JobRequest* request, proto::JobStatus* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Status"), [=](const UnaryCall& call) {
    call.Ask([=, job = JobId{request->job()}](CoreContext& core) {
      const auto status = core.farm.Status(core.now, job);
      if (status) Write(*status, *answer);
      return status ? grpc::Status::OK : NoJob(job);
    });
  });
}

grpc::ServerWriteReactor<proto::JobStatus>* JobsService::Watch(grpc::CallbackServerContext* context,
                                                               const proto::JobRequest* request) {
  using Reactor = grpc::ServerWriteReactor<proto::JobStatus>;
  return gate_.Serve<Reactor>(context, RuleFor("Jobs.Watch"), [=, this](const LastingCall& call) {
    auto* const stream = new WatchStream;
    const auto link = stream->link();
    // The core thread asks whether the caller still may, so this call is not kept.
    gate_.core().Post([=, this, job = JobId{request->job()}, caller = call.caller()](CoreContext& core) {
      const grpc::Status begun = GuardedStatus([&] {
        if (!core.farm.Status(core.now, job)) return NoJob(job);
        core.answers.Watch(
            job, [link](const JobStatus* status, bool last) { return link->Offer(status, last); },
            [=, this] {
              const grpc::Status admitted = gate_.Recheck(caller);
              if (!admitted.ok()) link->Finish(admitted);
              return admitted.ok() && link->IsOpen();
            });
        return grpc::Status::OK;
      });
      if (!begun.ok()) link->Finish(begun);
    });
    return stream;
  });
}

grpc::ServerUnaryReactor* JobsService::Workers(grpc::CallbackServerContext* context,
                                               const proto::WorkersRequest* request,
                                               proto::WorkersAnswer* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Workers"), [=](const UnaryCall& call) {
    call.Ask([=, which = CleanName(request->which())](CoreContext& core) {
      const auto workers =
          which.empty() ? core.farm.Workers(core.now) : core.farm.FindWorkers(core.now, which);
      Write(workers, *answer);
      return grpc::Status::OK;
    });
  });
}

grpc::ServerUnaryReactor* JobsService::Frames(grpc::CallbackServerContext* context,
                                              const proto::JobRequest* request, proto::FramesAnswer* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Frames"), [=](const UnaryCall& call) {
    call.Ask([=, job = JobId{request->job()}](CoreContext& core) {
      const std::vector<FrameStatus> frames = core.farm.Frames(job);
      if (frames.empty() && core.farm.Spec(job) != nullptr)
        return grpc::Status(grpc::StatusCode::FAILED_PRECONDITION,
                            fmt::format("job {} has no frames: its scene is not prepared", Number(job)));
      Write(frames, *answer);
      return frames.empty() ? NoJob(job) : grpc::Status::OK;
    });
  });
}

grpc::ServerWriteReactor<proto::PictureChunk>* JobsService::FetchPicture(grpc::CallbackServerContext* context,
                                                                         const proto::FetchRequest* request) {
  return pictures_.Fetch(context, *request);
}

grpc::ServerUnaryReactor* JobsService::JobLog(grpc::CallbackServerContext* context,
                                              const proto::JobLogRequest* request,
                                              proto::JobLogAnswer* answer) {
  return gate_.Unary(context, RuleFor("Jobs.JobLog"), [=, this](const UnaryCall& call) {
    const JobId job{request->job()};
    const size_t limit = request->limit() == 0 ? kLogEntriesPerCallMax : request->limit();
    if (limit > kLogEntriesPerCallMax)
      return call.Finish(ToStatus(BadInput("message refused: limit is out of range")));
    const auto page = log_.Read(job, request->after(), limit);
    if (!page) return call.Finish(NoJob(job));
    Write(*page, *answer);
    call.Finish(grpc::Status::OK);
  });
}

grpc::ServerUnaryReactor* JobsService::Health(grpc::CallbackServerContext* context,
                                              const proto::HealthRequest*, proto::HealthAnswer* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Health"), [=, this](const UnaryCall& call) {
    answer->set_software_version(kSoftwareVersion);
    answer->set_protocol(kProtocolVersion);
    answer->set_farm(WriteFarmId(gate_.farm()));
    answer->set_unix_time_ms(std::chrono::duration_cast<std::chrono::milliseconds>(
                                 std::chrono::system_clock::now().time_since_epoch())
                                 .count());
    call.Finish(grpc::Status::OK);
  });
}

}  // namespace tessera
