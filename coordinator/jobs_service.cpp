#include "coordinator/jobs_service.h"

#include <fmt/format.h>

#include "coordinator/core_thread.h"
#include "coordinator/picture_stream.h"
#include "coordinator/submission.h"
#include "coordinator/watch_stream.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"

namespace tessera {
namespace {

grpc::Status NoJob(JobId job) {
  return {grpc::StatusCode::NOT_FOUND, fmt::format("there is no job {}", Number(job))};
}

grpc::Status NoWorker(const std::string& which) {
  return {grpc::StatusCode::NOT_FOUND,
          fmt::format("there is no worker \"{}\"; tessera workers lists them", ReadReason(which))};
}

// Answered with the job's status once the change is on stable storage.
void ChangeJob(CoreThread& thread, grpc::ServerUnaryReactor* reactor, JobId job, proto::JobStatus* answer,
               std::function<Result<JobStatus>(CoreContext&, JobId)> change) {
  thread.Post([=, change = std::move(change)](CoreContext& core) {
    if (!core.farm.Status(core.now, job)) {
      reactor->Finish(NoJob(job));
      return;
    }
    const auto status = change(core, job);
    core.answers.AfterSync([=](bool synced) {
      if (status) Write(*status, *answer);
      reactor->Finish(!status ? ToStatus(status.error()) : synced ? grpc::Status::OK : CoordinatorEnds());
    });
  });
}

// Answered with the workers' status once the change is on stable storage.
void ChangeWorkers(CoreThread& thread, grpc::ServerUnaryReactor* reactor, const std::string& which,
                   proto::WorkersAnswer* answer, std::function<void(Farm&, WorkerId)> change) {
  thread.Post([=, change = std::move(change)](CoreContext& core) {
    const auto found = core.farm.FindWorkers(core.now, which);
    for (const WorkerStatus& worker : found) change(core.farm, worker.worker);
    const auto changed = core.farm.FindWorkers(core.now, which);
    core.answers.AfterSync([=](bool synced) {
      for (const WorkerStatus& worker : changed) Write(worker, *answer->add_workers());
      reactor->Finish(changed.empty() ? NoWorker(which) : synced ? grpc::Status::OK : CoordinatorEnds());
    });
  });
}

}  // namespace

grpc::ServerUnaryReactor* JobsService::Submit(grpc::CallbackServerContext* context,
                                              const proto::JobSpec* request, proto::SubmitAnswer* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  auto spec = ReadJobSpec(*request);
  if (!spec) {
    reactor->Finish(ToStatus(spec.error()));
    return reactor;
  }
  if (const auto checked = CheckSubmission(*spec, blobs_); !checked) {
    reactor->Finish(ToStatus(checked.error()));
    return reactor;
  }
  const auto shared = std::make_shared<const JobSpec>(std::move(*spec));
  core_.Post([=](CoreContext& core) {
    const auto job = core.farm.Submit(core.now, shared);
    core.answers.AfterSync([=](bool synced) {
      if (job) answer->set_job(Number(*job));
      reactor->Finish(!job ? ToStatus(job.error()) : synced ? grpc::Status::OK : CoordinatorEnds());
    });
  });
  return reactor;
}

grpc::ServerUnaryReactor* JobsService::List(grpc::CallbackServerContext* context, const proto::ListRequest*,
                                            proto::ListAnswer* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  core_.Post([=](CoreContext& core) {
    for (const JobStatus& status : core.farm.Jobs(core.now)) Write(status, *answer->add_jobs());
    reactor->Finish(grpc::Status::OK);
  });
  return reactor;
}

grpc::ServerUnaryReactor* JobsService::Status(grpc::CallbackServerContext* context,
                                              const proto::JobRequest* request, proto::JobStatus* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  core_.Post([=, job = JobId{request->job()}](CoreContext& core) {
    const auto status = core.farm.Status(core.now, job);
    if (status) Write(*status, *answer);
    reactor->Finish(status ? grpc::Status::OK : NoJob(job));
  });
  return reactor;
}

grpc::ServerWriteReactor<proto::JobStatus>* JobsService::Watch(grpc::CallbackServerContext*,
                                                               const proto::JobRequest* request) {
  auto* const stream = new WatchStream;
  const auto link = stream->link();
  core_.Post([=, job = JobId{request->job()}](CoreContext& core) {
    if (!core.farm.Status(core.now, job)) {
      link->Finish(NoJob(job));
      return;
    }
    core.answers.Watch(job, [link](const JobStatus* status, bool last) { return link->Offer(status, last); });
  });
  return stream;
}

grpc::ServerUnaryReactor* JobsService::Cancel(grpc::CallbackServerContext* context,
                                              const proto::JobRequest* request, proto::JobStatus* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  ChangeJob(core_, reactor, JobId{request->job()}, answer,
            [](CoreContext& core, JobId job) { return core.farm.Cancel(core.now, job); });
  return reactor;
}

grpc::ServerUnaryReactor* JobsService::Pause(grpc::CallbackServerContext* context,
                                             const proto::JobRequest* request, proto::JobStatus* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  ChangeJob(core_, reactor, JobId{request->job()}, answer,
            [](CoreContext& core, JobId job) { return core.farm.SetPaused(core.now, job, true); });
  return reactor;
}

grpc::ServerUnaryReactor* JobsService::Resume(grpc::CallbackServerContext* context,
                                              const proto::JobRequest* request, proto::JobStatus* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  ChangeJob(core_, reactor, JobId{request->job()}, answer,
            [](CoreContext& core, JobId job) { return core.farm.SetPaused(core.now, job, false); });
  return reactor;
}

grpc::ServerUnaryReactor* JobsService::SetPriority(grpc::CallbackServerContext* context,
                                                   const proto::PriorityRequest* request,
                                                   proto::JobStatus* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  const auto priority = ReadPriority(request->priority());
  if (!priority) {
    reactor->Finish(ToStatus(priority.error()));
    return reactor;
  }
  ChangeJob(core_, reactor, JobId{request->job()}, answer,
            [priority = *priority](CoreContext& core, JobId job) {
              return core.farm.SetPriority(core.now, job, priority);
            });
  return reactor;
}

grpc::ServerUnaryReactor* JobsService::Extend(grpc::CallbackServerContext* context,
                                              const proto::ExtendRequest* request, proto::JobStatus* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  const JobId job{request->job()};
  const uint32_t samples = request->samples_per_pixel();
  if (samples < 1 || samples > kSamplesPerPixelMax) {
    reactor->Finish(
        {grpc::StatusCode::INVALID_ARGUMENT, "message refused: samples_per_pixel are beyond the limit"});
    return reactor;
  }
  const auto extend = [=](CoreContext& core) {
    if (core.farm.IsMovingSums(job)) {
      reactor->Finish({grpc::StatusCode::UNAVAILABLE, "a picture of the job is being written; try again"});
      return;
    }
    const auto status = core.farm.Extend(core.now, job, samples);
    core.answers.AfterSync([=](bool synced) {
      if (status) Write(*status, *answer);
      reactor->Finish(!status ? ToStatus(status.error()) : synced ? grpc::Status::OK : CoordinatorEnds());
    });
  };
  // Blobs may have gone since the job ended. Looking takes long: not on the core thread.
  const auto check = [=, this](const JobSpec& spec) {
    if (const auto checked = CheckSubmission(spec, blobs_); !checked) {
      reactor->Finish(ToStatus(Failed(checked.error().message + "; submit the scene again")));
    } else {
      core_.Post(extend);
    }
  };
  core_.Post([=, this](CoreContext& core) {
    if (const auto spec = core.farm.Spec(job)) {
      background_.Post([=] { check(*spec); });
    } else {
      reactor->Finish(NoJob(job));
    }
  });
  return reactor;
}

grpc::ServerUnaryReactor* JobsService::Workers(grpc::CallbackServerContext* context,
                                               const proto::WorkersRequest* request,
                                               proto::WorkersAnswer* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  core_.Post([=, which = request->which()](CoreContext& core) {
    const auto workers = which.empty() ? core.farm.Workers(core.now) : core.farm.FindWorkers(core.now, which);
    for (const WorkerStatus& status : workers) Write(status, *answer->add_workers());
    reactor->Finish(grpc::Status::OK);
  });
  return reactor;
}

grpc::ServerUnaryReactor* JobsService::Frames(grpc::CallbackServerContext* context,
                                              const proto::JobRequest* request, proto::FramesAnswer* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  core_.Post([=, job = JobId{request->job()}](CoreContext& core) {
    const std::vector<FrameStatus> frames = core.farm.Frames(job);
    Write(frames, *answer);
    reactor->Finish(frames.empty() ? NoJob(job) : grpc::Status::OK);
  });
  return reactor;
}

grpc::ServerUnaryReactor* JobsService::DrainWorkers(grpc::CallbackServerContext* context,
                                                    const proto::WorkersRequest* request,
                                                    proto::WorkersAnswer* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  ChangeWorkers(core_, reactor, request->which(), answer,
                [](Farm& farm, WorkerId worker) { farm.Drain(worker); });
  return reactor;
}

grpc::ServerUnaryReactor* JobsService::ReleaseWorkers(grpc::CallbackServerContext* context,
                                                      const proto::WorkersRequest* request,
                                                      proto::WorkersAnswer* answer) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  ChangeWorkers(core_, reactor, request->which(), answer,
                [](Farm& farm, WorkerId worker) { farm.Release(worker); });
  return reactor;
}

grpc::ServerWriteReactor<proto::PictureChunk>* JobsService::FetchPicture(grpc::CallbackServerContext*,
                                                                         const proto::FetchRequest* request) {
  auto* const stream = new PictureStream;
  const JobId job{request->job()};
  const uint32_t frame = request->frame();
  core_.Post([=, this, preview = request->preview()](CoreContext& core) {
    const auto status = core.farm.Status(core.now, job);
    if (!status || frame >= status->frames_total) {
      const std::string what = status ? fmt::format("job {} has no frame {}", Number(job), frame) : "";
      stream->Refuse(status ? grpc::Status(grpc::StatusCode::NOT_FOUND, what) : NoJob(job));
    } else if (core.farm.FinishedFile(job, frame)) {
      background_.Post([=, path = directory_.PicturePath(job, frame)] { stream->SendFile(path); });
    } else if (auto picture = preview ? core.farm.Preview(job, frame) : std::nullopt) {
      const auto shared = std::make_shared<const FinishedPicture>(std::move(*picture));
      background_.Post([=] { stream->SendPicture(*shared); });
    } else {
      const char* const state = JobStateName(status->state);
      stream->Refuse(
          {grpc::StatusCode::FAILED_PRECONDITION,
           fmt::format("frame {} of job {} is not finished: the job is {}, {} of {} samples are done", frame,
                       Number(job), state, status->samples_done, status->samples_total)});
    }
  });
  return stream;
}

grpc::ServerUnaryReactor* JobsService::Health(grpc::CallbackServerContext* context,
                                              const proto::HealthRequest*, proto::HealthAnswer* answer) {
  answer->set_software_version(kSoftwareVersion);
  answer->set_protocol(kProtocolVersion);
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  reactor->Finish(grpc::Status::OK);
  return reactor;
}

}  // namespace tessera
