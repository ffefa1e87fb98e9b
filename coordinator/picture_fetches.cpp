#include "coordinator/picture_fetches.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "coordinator/call_gate.h"
#include "coordinator/guarded.h"
#include "coordinator/picture_writer.h"
#include "proto/wire/channel.h"

namespace tessera {
namespace {

// Of a job that has ended.
Result<std::string> NothingRendered(JobId job, int frame_number) {
  return BadInput(fmt::format("nothing was rendered of frame {} of job {}", frame_number, Number(job)));
}

grpc::Status NotFinished(const JobStatus& status, int frame_number) {
  return {grpc::StatusCode::FAILED_PRECONDITION,
          fmt::format("frame {} of job {} is not finished: the job is {}, {} of {} samples are done",
                      frame_number, Number(status.job), JobStateName(status.state), status.samples_done,
                      status.samples_total)};
}

}  // namespace

grpc::Status PictureFetches::BeingWritten() {
  return TryAgain("a picture of the job is being written");
}

grpc::ServerWriteReactor<proto::PictureChunk>* PictureFetches::Fetch(grpc::CallbackServerContext* context,
                                                                     const proto::FetchRequest& request) {
  using Reactor = grpc::ServerWriteReactor<proto::PictureChunk>;
  const CallRule& rule = RuleFor("Jobs.FetchPicture");
  return gate_.Serve<Reactor>(context, rule, [&, this](LastingCall call) {
    const Principal caller = call.caller();
    auto* const stream = new PictureStream(streams_, std::move(call));
    auto place = streams_.open.Take(caller);
    if (!place) {
      stream->Refuse(TryAgain(place.error().message));
      return stream;
    }
    stream->HoldPlace(std::move(*place));
    const FrameId id{JobId{request.job()}, request.frame()};
    gate_.core().Post([=, &rule, this, preview = request.preview()](CoreContext& core) {
      const grpc::Status begun = GuardedStatus([&] {
        const grpc::Status admitted = gate_.AdmitToJob(caller, rule, core, id.job);
        return admitted.ok() ? Begin(core, stream, id, preview) : admitted;
      });
      if (!begun.ok()) stream->Refuse(begun);
    });
    return stream;
  });
}

grpc::Status PictureFetches::Begin(CoreContext& core, PictureStream* stream, FrameId id, bool preview) {
  const auto status = core.farm.Status(core.now, id.job);
  if (id.frame >= status->frames_total) {
    return {grpc::StatusCode::NOT_FOUND, fmt::format("job {} has no frame {}", Number(id.job), id.frame)};
  }
  if (const auto file = core.farm.FinishedFile(id.job, id.frame)) return SendFile(stream, id, *file);
  const int number = core.farm.Spec(id.job)->frames[id.frame].number;
  if (preview && HasEnded(status->state)) {
    if (core.farm.IsMovingSums(id.job)) return BeingWritten();
    return SendLater(stream, [=, this] {
      auto bytes = pictures_.ReadPartial(id.job, id.frame);
      return bytes ? bytes : NothingRendered(id.job, number);
    });
  }
  auto picture = preview ? core.farm.Preview(id.job, id.frame) : std::nullopt;
  if (!picture) return NotFinished(*status, number);
  const auto shared = std::make_shared<const FinishedPicture>(std::move(*picture));
  return SendLater(stream, [=] { return EncodePreview(*shared); });
}

grpc::Status PictureFetches::SendLater(PictureStream* stream, std::function<Result<std::string>()> make,
                                       std::function<void(const std::string& reason)> refuse) {
  auto taken = streams_.waiting.Take(stream->caller());
  if (!taken) return TryAgain(taken.error().message);
  // Shared, as tasks are copied.
  const auto place = std::make_shared<MemberPlaces::Place>(std::move(*taken));
  background_.Post([=, this, make = std::move(make), refuse = std::move(refuse)] {
    const bool is_wanted = !stream->is_cancelled();
    auto bytes = is_wanted ? GuardedResult(make) : Result<std::string>(Failed("nobody reads the picture"));
    if (is_wanted && !bytes && refuse) {
      refuse(bytes.error().message);
    } else {
      stream->Send(std::move(bytes));
    }
    *place = {};
  });
  return grpc::Status::OK;
}

// What was damaged since it was written is not sent. It is made again if that is possible.
grpc::Status PictureFetches::SendFile(PictureStream* stream, FrameId id, const PictureFile& file) {
  const auto read = [=, this] {
    auto bytes = pictures_.Read(id.job, id.frame, file);
    if (bytes) gate_.core().Post([id](CoreContext& core) { core.farm.PictureIntact(id); });
    return bytes;
  };
  const auto refuse = [=, this](const std::string& reason) {
    gate_.core().Post([=](CoreContext& core) {
      stream->Refuse(GuardedStatus([&] {
        const auto lost = core.farm.PictureDamaged(id, reason);
        return lost ? grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, *lost)
                    : TryAgain(reason + "; it is being made again");
      }));
    });
  };
  return SendLater(stream, read, refuse);
}

}  // namespace tessera
