// Messages that would take a multiple of their size, or much more than a message may take.
#include <gmock/gmock.h>

#include <list>
#include <thread>

#include "proto/blobs.grpc.pb.h"
#include "proto/jobs.grpc.pb.h"
#include "proto/probe.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "proto/work.grpc.pb.h"
#include "renderer/film/radiance_tile.h"
#include "tests/end_to_end/farm_fixture.h"
#include "tests/end_to_end/hostile_client.h"
#include "tests/sanitizers.h"

namespace tessera {
namespace {

class HostileMessages : public EndToEnd {
 protected:
  HostileMessages() { StartCoordinator({"--insecure"}); }
  ~HostileMessages() override {
    EXPECT_LT(PeakBytes(coordinator().pid()), kPeakBytesMax);
    std::cout << "peak: " << (PeakBytes(coordinator().pid()) >> 20) << " MB\n";
    EXPECT_EQ(Ask({"jobs"}).code, 0) << "honest clients are served";
  }
  static constexpr size_t kGigabyte = size_t{1} << 30;
  static constexpr size_t kPiece = size_t{1} << 20;
};

TEST_F(HostileMessages, AMessageOfAGigabyteIsNeverHeldWhole) {
  HostileClient client(address());
  EXPECT_FALSE(client.Send("Jobs/Submit", HostileClient::Repeated(std::string(kPiece, 'x'), 1024)).ok());
}

TEST_F(HostileMessages, ManyLargeMessagesShareTheMemoryOfOne) {
  std::vector<std::jthread> clients;
  for (int i = 0; i < 8; ++i) {
    clients.emplace_back([address = address()] {
      HostileClient client(address);
      EXPECT_FALSE(client.Send("Jobs/Status", HostileClient::Repeated(std::string(kPiece, 'x'), 256)).ok());
    });
  }
}

TEST_F(HostileMessages, ACompressedMessageIsRefusedBeforeItIsUnpacked) {
  HostileClient client(address());
  for (const auto algorithm : {GRPC_COMPRESS_GZIP, GRPC_COMPRESS_DEFLATE}) {
    const auto status =
        client.Send("Jobs/Submit", HostileClient::Repeated(std::string(kPiece, '\0'), 200), algorithm);
    EXPECT_FALSE(status.ok()) << status.error_message();
  }
  EXPECT_LT(PeakBytes(coordinator().pid()), MemoryBound(size_t{100} << 20));
}

// Two bytes on the wire are an element of some hundred bytes in memory.
TEST_F(HostileMessages, MillionsOfEmptyElementsAreRefusedInLittleMemory) {
  HostileClient client(address());
  const struct {
    const char* method;
    int field;
  } cases[] = {{"Jobs/Submit", 5},       {"Work/Synchronize", 10}, {"Work/Synchronize", 15},
               {"Blobs/FindMissing", 1}, {"Jobs/Cancel", 99},      {"Work/ReturnFailure", 100}};
  for (const auto& [method, field] : cases) {
    std::string piece;
    while (piece.size() < kPiece) piece += HostileClient::FieldHead(field % 16, 0);
    for (const size_t count : {1, 3, 20}) {
      const auto status = client.Send(method, HostileClient::Repeated(piece, count));
      const bool is_refused = status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED ||
                              status.error_code() == grpc::StatusCode::INVALID_ARGUMENT;
      EXPECT_TRUE(is_refused) << method << ": " << status.error_message();
    }
  }
}

// 8 KB of zeros stand for 64 MB of values.
TEST_F(HostileMessages, TilesThatNobodyRequestedAreNotUnpacked) {
  Submit(BoxScene(), {"--spp", "64"});
  RadianceTile huge{{0, 0, kTileSizeMax, kTileSizeMax}, {0, 1}, {255}, {}};
  huge.sums.resize(static_cast<size_t>(huge.bounds.area()) * huge.shape.stride());
  huge.sums[0] = 1;
  proto::ResultsRequest results;
  for (int i = 0; i < kResultsPerCallMax; ++i) {
    proto::UnitResult& result = *results.add_results();
    tessera::Write(WorkUnit{JobId{1}, 0, 0, {0, 1}}, *result.mutable_unit());
    result.set_tile(EncodeRadianceTile(huge));
  }
  proto::ResultsRequest announcement;
  announcement.set_worker(7);
  announcement.set_bytes(results.ByteSizeLong());
  const auto work = proto::Work::NewStub(OpenChannel(*ParseAddress(address(), "test")));
  WorkerState state;
  state.worker = WorkerId{7};
  state.sequence = 1;
  state.name = "hostile";
  const Digest probe = *Digest::FromHex(kProbeDigest);
  state.probe_digest.assign(probe.bytes.begin(), probe.bytes.end());
  proto::WorkerState joining;
  tessera::Write(state, joining);
  grpc::ClientContext join_context;
  proto::WorkerDirective directive;
  ASSERT_TRUE(work->Synchronize(&join_context, joining, &directive).ok());
  // What it takes in truth, and nothing at all.
  for (const uint64_t decoded_bytes : {uint64_t{100} << 20, uint64_t{0}}) {
    announcement.set_decoded_bytes(decoded_bytes);
    grpc::ClientContext context;
    proto::ResultsAnswer answer;
    const auto writer = work->ReturnResults(&context, &answer);
    writer->Write(announcement);
    writer->WriteLast(results, {});
    EXPECT_TRUE(writer->Finish().ok());
    EXPECT_THAT(answer.verdicts(), testing::Each(proto::ResultsAnswer::OBSOLETE));
  }
  EXPECT_LT(PeakBytes(coordinator().pid()), MemoryBound(size_t{100} << 20));
}

// 275 GB.
TEST_F(HostileMessages, AFrameThatNoMemoryHoldsIsRefusedWhenItIsSubmitted) {
  Submit(BoxScene(), {"--spp", "1"});
  proto::JobSpec job;
  job.set_submission(99);
  job.set_package(std::string(32, 'x'));
  FrameSpec frame;
  frame.width = frame.height = 16384;
  frame.crop = {0, 0, frame.width, frame.height};
  frame.samples_per_pixel = 1;
  std::vector<std::string> names;
  for (int i = 0; i < 250; ++i) names.push_back("c" + std::to_string(i));
  frame.channels = ColorsAndWeight(names);
  frame.tile_size = 32;
  proto::FrameRequest& request = *job.add_frames();
  request.set_scene_file("scene.pbrt");
  tessera::Write(frame, *request.mutable_spec());
  grpc::ClientContext context;
  proto::SubmitAnswer answer;
  const auto jobs = proto::Jobs::NewStub(OpenChannel(*ParseAddress(address(), "test")));
  const auto status = jobs->Submit(&context, job, &answer);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), testing::HasSubstr("needs more memory"));
}

TEST_F(HostileMessages, APreviewOfAHugeFrameTakesLittleMemory) {
  const std::string job =
      Submit(BoxScene(), {"--spp", "1", "--resolution", "16384x16384", "--tile-size", "256"});
  const Outcome fetched = Ask({"fetch", job, "--preview", "-o", Path("preview.exr")});
  EXPECT_EQ(fetched.code, 0) << fetched.errors;
}

TEST_F(HostileMessages, PreviewsThatNobodyReadsAreNotMade) {
  const std::string job = Submit(BoxScene(), {"--spp", "1", "--resolution", "3840x2160"});
  const auto jobs = proto::Jobs::NewStub(OpenChannel(*ParseAddress(address(), "test")));
  proto::FetchRequest request;
  request.set_job(std::stoull(job));
  request.set_preview(true);
  for (int i = 0; i < 150; ++i) {
    grpc::ClientContext context;
    const auto reader = jobs->FetchPicture(&context, request);
    context.TryCancel();
    reader->Finish();
  }
  // Slow readers hold nothing but a chunk each.
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
  std::vector<std::unique_ptr<grpc::ClientReader<proto::PictureChunk>>> readers;
  for (int i = 0; i < 40; ++i) {
    contexts.push_back(std::make_unique<grpc::ClientContext>());
    readers.push_back(jobs->FetchPicture(contexts.back().get(), request));
  }
  EXPECT_EQ(Ask({"jobs"}).code, 0);
  for (const auto& context : contexts) context->TryCancel();
}

// Uploads that send nothing take all places of those who are no members.
TEST_F(HostileMessages, ASubmitThatWaitsForOtherTransfersNamesThemAndGoesOnAfterThem) {
  const auto blobs = proto::Blobs::NewStub(OpenChannel(*ParseAddress(address(), "test")));
  struct Silent {
    grpc::ClientContext context;
    proto::UploadAnswer answer;
    std::unique_ptr<grpc::ClientWriter<proto::UploadChunk>> writer;
  };
  std::list<Silent> silent;
  proto::UploadChunk chunk;
  chunk.set_size(100);
  for (int i = 0; i < 12; ++i) {
    Silent& each = silent.emplace_back();
    each.writer = blobs->Upload(&each.context, &each.answer);
    chunk.set_digest(WriteDigest(Sha256(std::to_string(i))));
    ASSERT_TRUE(each.writer->Write(chunk));
  }
  Process submit(folder(), "tessera", {"submit", BoxScene(), "--coordinator", address()});
  EXPECT_TRUE(submit.AwaitErrors("too many transfers are running")) << submit.Errors();
  EXPECT_THAT(submit.Errors(), testing::HasSubstr("waiting to send"));
  for (Silent& each : silent) {
    each.context.TryCancel();
    each.writer->Finish();
  }
  EXPECT_EQ(submit.Wait(), 0) << submit.Errors();
}

}  // namespace
}  // namespace tessera
