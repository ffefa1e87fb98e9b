#include "coordinator/jobs_service.h"

#include <fmt/format.h>

#include "coordinator/answer_limit.h"
#include "coordinator/call_gate.h"
#include "coordinator/guarded.h"
#include "coordinator/job_log.h"
#include "coordinator/submission.h"
#include "coordinator/task_pool.h"
#include "coordinator/watch_stream.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

grpc::Status NoJob(JobId job) {
  return {grpc::StatusCode::NOT_FOUND, fmt::format("there is no job {}", Number(job))};
}

grpc::Status NoWorker(const std::string& which) {
  return {grpc::StatusCode::NOT_FOUND,
          fmt::format("there is no worker \"{}\"; run `tessera workers` to list them", CleanName(which))};
}

// Writes the new status of a job, or returns why it was not changed.
grpc::Status Answer(const Result<JobStatus>& changed, proto::JobStatus& answer) {
  if (!changed) return ToStatus(changed.error());
  Write(*changed, answer);
  return grpc::Status::OK;
}

// Applies `change` to a job and answers with its new status.
void ChangeJob(const UnaryCall& call, JobId job, proto::JobStatus* answer,
               std::function<Result<JobStatus>(CoreContext&, JobId)> change) {
  call.Note(fmt::format("job={}", Number(job)));
  call.Apply([=, change = std::move(change)](CoreContext& core) {
    const grpc::Status admitted = call.AdmitToJob(core, job);
    return admitted.ok() ? Answer(change(core, job), *answer) : admitted;
  });
}

// Applies `change` to the workers named `which` and answers with their new status.
void ChangeWorkers(const UnaryCall& call, const std::string& which, proto::WorkersAnswer* answer,
                   std::function<void(Farm&, WorkerId)> change) {
  call.Note(fmt::format("worker={}", LogText(which)));
  call.Apply([=, change = std::move(change)](CoreContext& core) {
    for (const WorkerStatus& worker : core.farm.FindWorkers(core.now, which))
      change(core.farm, worker.worker);
    const auto changed = core.farm.FindWorkers(core.now, which);
    for (const WorkerStatus& worker : changed) Write(worker, *answer->add_workers());
    answer->set_left_out(KeepLast(*answer->mutable_workers()));
    return changed.empty() ? NoWorker(which) : grpc::Status::OK;
  });
}

// Why a job is not accepted, or not extended.
grpc::Status Refusal(const Error& error) {
  return error.kind == ErrorKind::kInterrupted ? TryAgain(error.message) : ToStatus(error);
}

Result<std::shared_ptr<const JobSpec>> ReadShared(const proto::JobSpec& request) {
  auto spec = ReadJobSpec(request);
  if (!spec) return spec.error();
  return std::make_shared<const JobSpec>(std::move(*spec));
}

}  // namespace

JobsService::JobsService(const CallGate& gate, const BlobStore& blobs, const PictureStore& pictures,
                         const class JobLog& log, const std::string& data_dir, FileThreads& threads)
    : gate_(gate),
      blobs_(blobs),
      log_(log),
      threads_(threads),
      pictures_(gate, pictures, data_dir, threads.brief) {
  const auto serve = [this](auto method, const CallRule& rule) {
    MarkMethodCallback(MethodIndex(rule), GuardedMethod(this, rule, method));
  };
  serve(&JobsService::Submit, RuleFor("Jobs.Submit"));
  serve(&JobsService::List, RuleFor("Jobs.List"));
  serve(&JobsService::Status, RuleFor("Jobs.Status"));
  serve(&JobsService::Watch, RuleFor("Jobs.Watch"));
  serve(&JobsService::Cancel, RuleFor("Jobs.Cancel"));
  serve(&JobsService::Extend, RuleFor("Jobs.Extend"));
  serve(&JobsService::Pause, RuleFor("Jobs.Pause"));
  serve(&JobsService::Resume, RuleFor("Jobs.Resume"));
  serve(&JobsService::SetPriority, RuleFor("Jobs.SetPriority"));
  serve(&JobsService::Workers, RuleFor("Jobs.Workers"));
  serve(&JobsService::Frames, RuleFor("Jobs.Frames"));
  serve(&JobsService::DrainWorkers, RuleFor("Jobs.DrainWorkers"));
  serve(&JobsService::ReleaseWorkers, RuleFor("Jobs.ReleaseWorkers"));
  serve(&JobsService::FetchPicture, RuleFor("Jobs.FetchPicture"));
  serve(&JobsService::JobLog, RuleFor("Jobs.JobLog"));
  serve(&JobsService::Health, RuleFor("Jobs.Health"));
}

grpc::ServerUnaryReactor* JobsService::Submit(grpc::CallbackServerContext* context,
                                              const proto::JobSpec* request, proto::SubmitAnswer* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Submit"), [=, this](const UnaryCall& call) {
    threads_.brief.Post([=, this] {
      const auto read = GuardedResult([&] { return ReadShared(*request); });
      if (!read) return call.Finish(ToStatus(read.error()));
      PostCheck(threads_, blobs_, (*read)->package, [=, this, spec = *read] {
        const auto checked = GuardedResult([&] { return CheckSubmission(*spec, blobs_); });
        if (!checked) return call.Finish(Refusal(checked.error()));
        const auto submit = [=](CoreContext& core) {
          const auto job = core.farm.Submit(core.now, spec, call.caller().Owner());
          if (!job && job.error().kind == ErrorKind::kBadInput) return ToStatus(job.error());
          if (!job) return grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, job.error().message);
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

grpc::ServerUnaryReactor* JobsService::Cancel(grpc::CallbackServerContext* context,
                                              const proto::JobRequest* request, proto::JobStatus* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Cancel"), [=](const UnaryCall& call) {
    ChangeJob(call, JobId{request->job()}, answer,
              [](CoreContext& core, JobId job) { return core.farm.Cancel(core.now, job); });
  });
}

grpc::ServerUnaryReactor* JobsService::Pause(grpc::CallbackServerContext* context,
                                             const proto::JobRequest* request, proto::JobStatus* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Pause"), [=](const UnaryCall& call) {
    ChangeJob(call, JobId{request->job()}, answer,
              [](CoreContext& core, JobId job) { return core.farm.SetPaused(core.now, job, true); });
  });
}

grpc::ServerUnaryReactor* JobsService::Resume(grpc::CallbackServerContext* context,
                                              const proto::JobRequest* request, proto::JobStatus* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Resume"), [=](const UnaryCall& call) {
    ChangeJob(call, JobId{request->job()}, answer,
              [](CoreContext& core, JobId job) { return core.farm.SetPaused(core.now, job, false); });
  });
}

grpc::ServerUnaryReactor* JobsService::SetPriority(grpc::CallbackServerContext* context,
                                                   const proto::PriorityRequest* request,
                                                   proto::JobStatus* answer) {
  return gate_.Unary(context, RuleFor("Jobs.SetPriority"), [=](const UnaryCall& call) {
    const auto priority = ReadPriority(request->priority());
    if (!priority) return call.Finish(ToStatus(priority.error()));
    ChangeJob(call, JobId{request->job()}, answer,
              [priority = *priority, call](CoreContext& core, JobId job) {
                call.Note(fmt::format("job={} priority={}", Number(job), priority));
                return core.farm.SetPriority(core.now, job, priority);
              });
  });
}

grpc::ServerUnaryReactor* JobsService::Extend(grpc::CallbackServerContext* context,
                                              const proto::ExtendRequest* request, proto::JobStatus* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Extend"), [=, this](const UnaryCall& call) {
    const JobId job{request->job()};
    const uint32_t samples = request->samples_per_pixel();
    if (samples < 1 || samples > kSamplesPerPixelMax)
      return call.Finish(ToStatus(BadInput("message refused: samples_per_pixel is out of range")));
    call.Note(fmt::format("job={} samples_per_pixel={}", Number(job), samples));
    const auto extend = [=](CoreContext& core) {
      if (core.farm.IsMovingSums(job)) return PictureFetches::BeingWritten();
      return Answer(core.farm.Extend(core.now, job, samples), *answer);
    };
    // Blobs may have been evicted since the job ended. Checking takes too long for the core thread.
    const auto check = [=, this](const JobSpec& spec) {
      const auto checked = GuardedResult([&] { return CheckSubmission(spec, blobs_); });
      if (checked) return call.Apply(extend);
      const bool is_late = checked.error().kind == ErrorKind::kInterrupted;
      call.Finish(
          Refusal(is_late ? checked.error() : Failed(checked.error().message + "; submit the scene again")));
    };
    call.core().Post([=, this](CoreContext& core) {
      const grpc::Status admitted = GuardedStatus([&] {
        if (const grpc::Status may = call.AdmitToJob(core, job); !may.ok()) return may;
        PostCheck(threads_, blobs_, core.farm.Spec(job)->package,
                  [check, spec = core.farm.Spec(job)] { check(*spec); });
        return grpc::Status::OK;
      });
      if (!admitted.ok()) call.Finish(admitted);
    });
  });
}

grpc::ServerUnaryReactor* JobsService::Workers(grpc::CallbackServerContext* context,
                                               const proto::WorkersRequest* request,
                                               proto::WorkersAnswer* answer) {
  return gate_.Unary(context, RuleFor("Jobs.Workers"), [=](const UnaryCall& call) {
    call.Ask([=, which = CleanName(request->which())](CoreContext& core) {
      const auto workers =
          which.empty() ? core.farm.Workers(core.now) : core.farm.FindWorkers(core.now, which);
      for (const WorkerStatus& status : workers) Write(status, *answer->add_workers());
      answer->set_left_out(KeepLast(*answer->mutable_workers()));
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

grpc::ServerUnaryReactor* JobsService::DrainWorkers(grpc::CallbackServerContext* context,
                                                    const proto::WorkersRequest* request,
                                                    proto::WorkersAnswer* answer) {
  return gate_.Unary(context, RuleFor("Jobs.DrainWorkers"), [=](const UnaryCall& call) {
    ChangeWorkers(call, CleanName(request->which()), answer,
                  [](Farm& farm, WorkerId worker) { farm.Drain(worker); });
  });
}

grpc::ServerUnaryReactor* JobsService::ReleaseWorkers(grpc::CallbackServerContext* context,
                                                      const proto::WorkersRequest* request,
                                                      proto::WorkersAnswer* answer) {
  return gate_.Unary(context, RuleFor("Jobs.ReleaseWorkers"), [=](const UnaryCall& call) {
    ChangeWorkers(call, CleanName(request->which()), answer,
                  [](Farm& farm, WorkerId worker) { farm.Release(worker); });
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
