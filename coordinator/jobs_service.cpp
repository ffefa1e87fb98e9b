#include "coordinator/jobs_service.h"

#include <fmt/format.h>

#include "coordinator/answer_limit.h"
#include "coordinator/call_gate.h"
#include "coordinator/guarded.h"
#include "coordinator/job_log.h"
#include "coordinator/picture_stream.h"
#include "coordinator/picture_writer.h"
#include "coordinator/submission.h"
#include "coordinator/task_pool.h"
#include "coordinator/watch_stream.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr int kPictureStreamsMax = 64;  // with a file and a chunk each
// That wait for the thread that makes previews and reads pictures. Each keeps sums that the frame has
// replaced.
constexpr int kPicturesWaitingMax = 16;

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

grpc::Status BeingWritten() {
  return TryAgain("a picture of the job is being written");
}

// Of a job that has ended.
Result<std::string> NothingRendered(JobId job, uint32_t frame) {
  return BadInput(fmt::format("nothing was rendered of frame {} of job {}", frame, Number(job)));
}

grpc::Status NotFinished(const JobStatus& status, uint32_t frame) {
  return {
      grpc::StatusCode::FAILED_PRECONDITION,
      fmt::format("frame {} of job {} is not finished: the job is {}, {} of {} samples are done", frame,
                  Number(status.job), JobStateName(status.state), status.samples_done, status.samples_total)};
}

}  // namespace

JobsService::JobsService(const CallGate& gate, const BlobStore& blobs, const PictureStore& pictures,
                         const class JobLog& log, const std::string& data_dir, FileThreads& threads)
    : gate_(gate), blobs_(blobs), pictures_(pictures), log_(log), threads_(threads) {
  streams_.folder = data_dir;
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
      auto spec = ReadJobSpec(*request);
      if (!spec) return call.Finish(ToStatus(spec.error()));
      if (const auto checked = CheckSubmission(*spec, blobs_); !checked)
        return call.Finish(ToStatus(checked.error()));
      const auto shared = std::make_shared<const JobSpec>(std::move(*spec));
      const auto submit = [=](CoreContext& core) {
        const auto job = core.farm.Submit(core.now, shared, call.caller().Owner());
        if (!job && job.error().kind == ErrorKind::kBadInput) return ToStatus(job.error());
        if (!job) return grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, job.error().message);
        answer->set_job(Number(*job));
        call.Note(fmt::format("job={} name={}", Number(*job), LogText(shared->name)));
        return grpc::Status::OK;
      };
      call.Apply(submit, request->ByteSizeLong());
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
      if (!core.farm.Status(core.now, job)) return link->Finish(NoJob(job));
      core.answers.Watch(
          job, [link](const JobStatus* status, bool last) { return link->Offer(status, last); },
          [=, this] {
            const grpc::Status admitted = gate_.Recheck(caller);
            if (!admitted.ok()) link->Finish(admitted);
            return admitted.ok() && link->IsOpen();
          });
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
      if (core.farm.IsMovingSums(job)) return BeingWritten();
      return Answer(core.farm.Extend(core.now, job, samples), *answer);
    };
    call.core().Post([=, this](CoreContext& core) {
      if (const grpc::Status admitted = call.AdmitToJob(core, job); !admitted.ok())
        return call.Finish(admitted);
      const auto spec = core.farm.Spec(job);
      // Blobs may have been evicted since the job ended. Checking takes too long for the core thread.
      threads_.brief.Post([=, this] {
        const auto checked = CheckSubmission(*spec, blobs_);
        if (checked) return call.Apply(extend);
        call.Finish(ToStatus(Failed(checked.error().message + "; submit the scene again")));
      });
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
  using Reactor = grpc::ServerWriteReactor<proto::PictureChunk>;
  return gate_.Serve<Reactor>(context, RuleFor("Jobs.FetchPicture"), [=, this](LastingCall call) {
    const Principal caller = call.caller();
    auto* const stream = new PictureStream(streams_, std::move(call));
    if (streams_.count > kPictureStreamsMax) {
      stream->Refuse(TryAgain("too many pictures are being fetched"));
      return stream;
    }
    const JobId job{request->job()};
    const uint32_t frame = request->frame();
    gate_.core().Post([=, this, preview = request->preview()](CoreContext& core) {
      const grpc::Status admitted = gate_.AdmitToJob(caller, RuleFor("Jobs.FetchPicture"), core, job);
      if (!admitted.ok()) return stream->Refuse(admitted);
      const auto status = core.farm.Status(core.now, job);
      if (frame >= status->frames_total) {
        return stream->Refuse(
            {grpc::StatusCode::NOT_FOUND, fmt::format("job {} has no frame {}", Number(job), frame)});
      }
      if (const auto file = core.farm.FinishedFile(job, frame)) return SendFile(stream, {job, frame}, *file);
      if (preview && HasEnded(status->state)) {
        if (core.farm.IsMovingSums(job)) return stream->Refuse(BeingWritten());
        return SendLater(stream, [=, this] {
          auto bytes = pictures_.ReadPartial(job, frame);
          return bytes ? bytes : NothingRendered(job, frame);
        });
      }
      auto picture = preview ? core.farm.Preview(job, frame) : std::nullopt;
      if (!picture) return stream->Refuse(NotFinished(*status, frame));
      const auto shared = std::make_shared<const FinishedPicture>(std::move(*picture));
      SendLater(stream, [=] { return EncodePreview(*shared); });
    });
    return stream;
  });
}

void JobsService::SendLater(PictureStream* stream, std::function<Result<std::string>()> make,
                            std::function<void(const std::string& reason)> refuse) {
  if (++streams_.waiting > kPicturesWaitingMax) {
    --streams_.waiting;
    return stream->Refuse(TryAgain("too many pictures are waiting to be made"));
  }
  background_.Post([=, this, make = std::move(make), refuse = std::move(refuse)] {
    const bool is_wanted = !stream->is_cancelled();
    auto bytes = is_wanted ? GuardedResult(make) : Result<std::string>(Failed("nobody reads the picture"));
    if (is_wanted && !bytes && refuse) {
      refuse(bytes.error().message);
    } else {
      stream->Send(std::move(bytes));
    }
    --streams_.waiting;
  });
}

// What was damaged since it was written is not sent. It is made again if that is possible.
void JobsService::SendFile(PictureStream* stream, FrameId id, const PictureFile& file) {
  const auto read = [=, this] {
    auto bytes = pictures_.Read(id.job, id.frame, file);
    if (bytes) gate_.core().Post([id](CoreContext& core) { core.farm.PictureIntact(id); });
    return bytes;
  };
  const auto refuse = [=, this](const std::string& reason) {
    gate_.core().Post([=](CoreContext& core) {
      const auto lost = core.farm.PictureDamaged(id, reason);
      stream->Refuse(lost ? grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, *lost)
                          : TryAgain(reason + "; it is being made again"));
    });
  };
  SendLater(stream, read, refuse);
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
