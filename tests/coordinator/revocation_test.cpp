// Calls that last end soon after their member is revoked, whatever the peer does.
#include <algorithm>
#include <cstring>
#include <functional>
#include <future>
#include <memory>
#include <thread>

#include "renderer/util/hash.h"
#include "tests/coordinator/members_fixture.h"

namespace tessera {
namespace {

using grpc::StatusCode;
using testing::AnyOf;
using testing::HasSubstr;

// Far longer than it takes, far shorter than the time after which a silent peer is cut off anyway.
constexpr std::chrono::seconds kSoon{10};
constexpr uint64_t kMemoryBytes = 12345;

// Eight bytes of each hash.
std::string Noise(size_t size) {
  std::string bytes(size, '\0');
  for (size_t i = 0; i + sizeof(uint64_t) <= size; i += sizeof(uint64_t)) {
    const uint64_t noise = Hash(i);
    std::memcpy(bytes.data() + i, &noise, sizeof noise);
  }
  return bytes;
}

class Revocation : public ServicesForMembers {
 protected:
  // Revokes `name` and returns the status with which the call ends soon after.
  grpc::Status EndOf(const std::string& name, const std::function<grpc::Status()>& finish) {
    Revoke(name);
    auto end = std::async(std::launch::async, finish);
    EXPECT_EQ(end.wait_for(kSoon), std::future_status::ready);
    return end.get();
  }
  // A package of one file of noise that is too large for what a connection holds, in a job.
  Digest SubmitLargeFile() {
    const std::string bytes = Noise(size_t{16} << 20);
    ScenePackage package;
    package.files["scene.pbrt"] = {Sha256(bytes), bytes.size()};
    const std::string manifest = EncodeScenePackage(package);
    EXPECT_TRUE(UploadLarge(bytes).ok());
    EXPECT_TRUE(Upload(manifest, Sha256(manifest), manifest.size()).ok());
    proto::JobSpec job = PrepareJob();
    job.set_package(WriteDigest(Sha256(manifest)));
    proto::SubmitAnswer answer;
    EXPECT_TRUE(Call(*jobs, &proto::Jobs::Stub::Submit, job, answer).ok());
    large_file = Sha256(bytes);
    return Sha256(manifest);
  }
  grpc::Status UploadLarge(const std::string& bytes) {
    grpc::ClientContext context;
    SetDeadline(context, kPatience);
    proto::UploadAnswer answer;
    const auto writer = blobs->Upload(&context, &answer);
    proto::UploadChunk chunk;
    chunk.set_digest(WriteDigest(Sha256(bytes)));
    chunk.set_size(bytes.size());
    for (size_t at = 0; at < bytes.size(); at += kChunkBytesMax) {
      chunk.set_data(bytes.substr(at, kChunkBytesMax));
      if (!writer->Write(chunk)) break;
      chunk.Clear();
    }
    writer->WritesDone();
    return writer->Finish();
  }
  // A finished picture of noise, larger than what a connection holds.
  uint64_t FinishLargePicture() {
    proto::JobSpec job = PrepareJob();
    FrameSpec frame = *ReadFrameSpec(job.frames(0).spec());
    frame.width = 2048;
    frame.height = 512;
    frame.crop = {0, 0, frame.width, frame.height};
    frame.tile_size = 256;
    frame.samples_per_pixel = 1;
    job.mutable_frames(0)->mutable_spec()->Clear();
    Write(frame, *job.mutable_frames(0)->mutable_spec());
    scene_key = SceneKey(*ReadDigest(job.package(), "package"), "scene.pbrt", "", frame);
    proto::SubmitAnswer answer;
    const grpc::Status submitted = Call(*jobs, &proto::Jobs::Stub::Submit, job, answer);
    EXPECT_TRUE(submitted.ok()) << submitted.error_message();
    for (uint32_t tile = 0; tile < 16; ++tile) {
      RadianceTile radiance{frame.TileBounds(static_cast<int>(tile)), {0, 1}, {4}, {}};
      for (uint32_t i = 0; i < 256 * 256; ++i) {
        for (uint32_t c = 0; c < 3; ++c)
          radiance.sums.push_back(UniformFloat(static_cast<uint32_t>(Hash(tile, i, c))));
        radiance.sums.push_back(1);
      }
      proto::ResultsAnswer result;
      EXPECT_TRUE(Return(ResultOf(answer.job(), tile, {0, 1}, EncodeRadianceTile(radiance)), result).ok());
    }
    EXPECT_TRUE(ComesTrue([&] { return Status(answer.job()).state() == proto::JOB_STATE_FINISHED; }));
    return answer.job();
  }
  // Sends the first byte of a file that is not sent to its end.
  std::unique_ptr<grpc::ClientWriter<proto::UploadChunk>> BeginUpload(grpc::ClientContext& context,
                                                                      proto::UploadAnswer& answer,
                                                                      const std::string& contents) {
    auto writer = blobs->Upload(&context, &answer);
    proto::UploadChunk chunk;
    chunk.set_digest(WriteDigest(Sha256(contents)));
    chunk.set_size(contents.size());
    chunk.set_data(contents.substr(0, 1));
    EXPECT_TRUE(writer->Write(chunk));
    return writer;
  }
  // Reads one chunk and the rest only when the calls of the peer have ended, which a later one of them shows:
  // a stream whose messages are not read does not.
  template <typename Reader, typename Chunk>
  void ExpectCutOff(const std::string& name, Reader& reader, Chunk& chunk) {
    if (!reader.Read(&chunk)) FAIL() << reader.Finish().error_message();
    const uint64_t size = chunk.size();
    uint64_t received = chunk.data().size();
    grpc::ClientContext context;
    proto::UploadAnswer answer;
    const auto later = BeginUpload(context, answer, "never whole");
    EXPECT_FALSE(EndOf(name, [&] { return later->Finish(); }).ok());
    while (reader.Read(&chunk)) received += chunk.data().size();
    EXPECT_LT(received, size);
    EXPECT_THAT(reader.Finish().error_code(), AnyOf(StatusCode::CANCELLED, StatusCode::UNAUTHENTICATED));
  }
  // Whether the coordinator lists a worker whose process takes this memory.
  bool HasWorkerWith(uint64_t memory_bytes) {
    const auto local = proto::Jobs::NewStub(OpenChannel(coordinator->addresses().front()));
    proto::WorkersAnswer answer;
    Call(*local, &proto::Jobs::Stub::Workers, proto::WorkersRequest(), answer);
    return std::ranges::any_of(answer.workers(),
                               [&](const auto& worker) { return worker.memory_bytes() == memory_bytes; });
  }
  Digest large_file;
};

TEST_F(Revocation, AnUploadThatFlowsEndsWithTheReason) {
  CallAs(Join(Role::kUser, "ada"));
  grpc::ClientContext context;
  SetDeadline(context, kPatience);
  proto::UploadAnswer answer;
  const auto writer = blobs->Upload(&context, &answer);
  proto::UploadChunk chunk;
  chunk.set_digest(WriteDigest(Sha256("never whole")));
  chunk.set_size(uint64_t{1} << 30);
  chunk.set_data("x");
  ASSERT_TRUE(writer->Write(chunk));
  chunk.Clear();
  chunk.set_data("y");
  const grpc::Status status = EndOf("ada", [&] {
    while (writer->Write(chunk)) std::this_thread::sleep_for(milliseconds(1));
    return writer->Finish();
  });
  EXPECT_EQ(status.error_code(), StatusCode::UNAUTHENTICATED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("the certificate of user \"ada\" was revoked"));
}

TEST_F(Revocation, AnUploadThatStallsIsCutOffAndTheNextCallGivesTheReason) {
  CallAs(Join(Role::kUser, "ada"));
  grpc::ClientContext context;
  proto::UploadAnswer answer;
  const auto writer = BeginUpload(context, answer, "never whole");
  EXPECT_FALSE(EndOf("ada", [&] { return writer->Finish(); }).ok());
  proto::ListAnswer list;
  const grpc::Status next = Call(*jobs, &proto::Jobs::Stub::List, proto::ListRequest(), list);
  EXPECT_EQ(next.error_code(), StatusCode::UNAUTHENTICATED);
  EXPECT_THAT(next.error_message(), HasSubstr("was revoked; ask an operator of the farm for a token"));
}

TEST_F(Revocation, ADownloadIsCutOff) {
  const Digest package = SubmitLargeFile();
  CallAs(Join(Role::kOperator, "olga"));
  grpc::ClientContext context;
  SetDeadline(context, 2 * kPatience);
  proto::DownloadRequest request;
  request.set_digest(WriteDigest(large_file));
  request.set_package(WriteDigest(package));
  const auto reader = blobs->Download(&context, request);
  proto::DownloadChunk chunk;
  ExpectCutOff("olga", *reader, chunk);
}

TEST_F(Revocation, APictureIsCutOff) {
  const uint64_t job = FinishLargePicture();
  CallAs(Join(Role::kOperator, "olga"));
  grpc::ClientContext context;
  SetDeadline(context, 2 * kPatience);
  proto::FetchRequest request;
  request.set_job(job);
  const auto reader = jobs->FetchPicture(&context, request);
  proto::PictureChunk chunk;
  ExpectCutOff("olga", *reader, chunk);
}

TEST_F(Revocation, AWorkerThatWaitsForNewsIsGone) {
  CallAs(Join(Role::kWorker, "blade"));
  proto::WorkerDirective directive;
  ASSERT_TRUE(Synchronize(Worker(milliseconds(0)), directive).ok());
  auto waiting = std::async(std::launch::async, [&] {
    proto::WorkerDirective late;
    WorkerState state = Worker(kSynchronizeWaitMax);
    state.memory_bytes = kMemoryBytes;
    return Synchronize(state, late);
  });
  ASSERT_TRUE(ComesTrue([&] { return HasWorkerWith(kMemoryBytes); })) << "the call has arrived";
  const grpc::Status status = EndOf("blade", [&] { return waiting.get(); });
  EXPECT_THAT(status.error_code(), AnyOf(StatusCode::CANCELLED, StatusCode::UNAUTHENTICATED));
  CallAsLocalUser();
  EXPECT_TRUE(ComesTrue([&] { return WorkerCount() == 0; }));
}

// A worker returns its results when they are admitted, which may take long.
TEST_F(Revocation, AnAnnouncementOfResultsIsCutOff) {
  CallAs(Join(Role::kWorker, "blade"));
  proto::WorkerDirective directive;
  ASSERT_TRUE(Synchronize(Worker(milliseconds(0)), directive).ok());
  grpc::ClientContext context;
  proto::ResultsAnswer answer;
  const auto writer = work->ReturnResults(&context, &answer);
  proto::ResultsRequest announcement;
  announcement.set_worker(7);
  announcement.set_farm(WriteFarmId(farm));
  announcement.set_bytes(1000);
  announcement.set_decoded_bytes(1000);
  ASSERT_TRUE(writer->Write(announcement));
  EXPECT_FALSE(EndOf("blade", [&] { return writer->Finish(); }).ok());
}

TEST_F(Revocation, CallsOfOthersGoOn) {
  const JoinedFarm ada = Join(Role::kUser, "ada"), bob = Join(Role::kUser, "bob");
  grpc::ClientContext context, revoked_context;
  SetDeadline(context, kPatience);
  proto::UploadAnswer answer, no_answer;
  CallAs(ada);
  const auto kept_open = channel;
  const auto revoked = BeginUpload(revoked_context, no_answer, "never whole");
  CallAs(bob);
  const auto writer = BeginUpload(context, answer, "ab");
  EXPECT_FALSE(EndOf("ada", [&] { return revoked->Finish(); }).ok());
  proto::UploadChunk chunk;
  chunk.set_data("b");
  ASSERT_TRUE(writer->Write(chunk));
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  EXPECT_TRUE(status.ok()) << status.error_message();
}

}  // namespace
}  // namespace tessera
