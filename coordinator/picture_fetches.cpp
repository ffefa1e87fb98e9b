#include "coordinator/picture_fetches.h"

#include <fmt/format.h>

#include <exception>
#include <memory>
#include <utility>

#include "coordinator/call_gate.h"
#include "coordinator/guarded.h"
#include "coordinator/picture_writer.h"
#include "proto/wire/channel.h"

namespace tessera {
namespace {

// Of a job that has ended.
Error NothingRendered(JobId job, int frame_number) {
  return BadInput(fmt::format("nothing was rendered of frame {} of job {}", frame_number, Number(job)));
}

grpc::Status NotFinished(const JobStatus& status, int frame_number) {
  return {grpc::StatusCode::FAILED_PRECONDITION,
          fmt::format("frame {} of job {} is not finished: the job is {}, {} of {} samples are done",
                      frame_number, Number(status.job), JobStateName(status.state), status.samples_done,
                      status.samples_total)};
}

}  // namespace

PictureFetches::PictureFetches(const CallGate& gate, const PictureStore& pictures, TaskPool& brief)
    : gate_(gate), pictures_(pictures), streams_{gate.path().directory, brief} {}

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
  if (preview && (HasEnded(status->state) || core.farm.HasFailed(id))) {
    if (core.farm.IsMovingSums(id.job)) return BeingWritten();
    return SendLater(stream, [=, this]() -> Result<StoredPicture> {
      auto picture = pictures_.Open(id.job, id.frame, std::nullopt);
      if (!picture && picture.error().kind != ErrorKind::kInterrupted) return NothingRendered(id.job, number);
      return picture;
    });
  }
  auto picture = preview ? core.farm.Preview(id.job, id.frame) : std::nullopt;
  if (!picture) return NotFinished(*status, number);
  const auto shared = std::make_shared<const FinishedPicture>(std::move(*picture));
  return SendLater(stream, [=] { return EncodePreview(*shared); });
}

template <typename Make>
grpc::Status PictureFetches::SendLater(PictureStream* stream, Make make,
                                       std::function<void(const std::string& reason)> refuse) {
  auto taken = streams_.waiting.Take(stream->caller());
  if (!taken) return TryAgain(taken.error().message);
  // Shared, as tasks are copied.
  const auto place = std::make_shared<MemberPlaces::Place>(std::move(*taken));
  background_.Post([=, this, make = std::move(make), refuse = std::move(refuse)] {
    decltype(make()) picture = Failed("nobody reads the picture");
    bool is_damaged = false;
    try {
      if (!stream->is_cancelled()) {
        picture = make();
        is_damaged = !picture && picture.error().kind != ErrorKind::kInterrupted;
      }
    } catch (const std::exception& e) {
      picture = Failed(ReasonOf(e));
    }
    if (is_damaged && refuse) {
      refuse(picture.error().message);
    } else {
      stream->Send(std::move(picture));
    }
    *place = {};
  });
  return grpc::Status::OK;
}

// What was damaged since it was written is not sent. It is made again if that is possible.
grpc::Status PictureFetches::SendFile(PictureStream* stream, FrameId id, const PictureFile& file) {
  const auto read = [=, this] {
    auto picture = pictures_.Open(id.job, id.frame, file);
    if (picture) gate_.core().Post([id](CoreContext& core) { core.farm.PictureIntact(id); });
    return picture;
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
