// The coordinator's services over real gRPC on a Unix socket, spoken to as clients and workers do.
#include <gmock/gmock.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <gtest/gtest.h>

#include <fstream>
#include <future>

#include "coordinator/blob_service.h"
#include "coordinator/core_thread.h"
#include "coordinator/jobs_service.h"
#include "coordinator/picture_writer.h"
#include "coordinator/server.h"
#include "coordinator/work_service.h"
#include "film/picture_file.h"
#include "film/radiance_tile.h"
#include "store/file_journal.h"
#include "terms/scene_package.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "wire/channel.h"
#include "wire/convert.h"

namespace tessera {
namespace {

using grpc::StatusCode;
using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr milliseconds kPatience{20'000};

// A coordinator's parts as RunCoordinator joins them.
struct Coordinator {
  explicit Coordinator(const TemporaryDir& folder)
      : directory(*DataDir::Open(folder / "data")),
        blobs(*BlobStore::Open(directory.BlobsPath())),
        writer(directory) {
    auto farm = std::make_unique<Farm>(SchedulerOptions{});
    auto journal = FileJournal::Open(directory.JournalPath(), [&](const Fact& fact) { farm->Restore(fact); });
    core = std::make_unique<CoreThread>(
        std::move(farm), std::move(*journal),
        [this](FinishedPicture picture) { writer.Write(*core, std::move(picture)); });
    work = std::make_unique<WorkService>(*core);
    blob_service = std::make_unique<BlobService>(blobs);
    jobs = std::make_unique<JobsService>(*core, blobs, directory);
    const Address address = *ParseAddress("unix:" + (folder / "socket"), "test");
    server = std::move(*CoordinatorServer::Start({address}, *work, *blob_service, *jobs));
  }
  ~Coordinator() {
    core->Close();
    server->Shutdown();
    jobs->Stop();
    writer.Stop();
    core->Stop();
  }
  DataDir directory;
  BlobStore blobs;
  PictureWriter writer;
  std::unique_ptr<CoreThread> core;
  std::unique_ptr<WorkService> work;
  std::unique_ptr<BlobService> blob_service;
  std::unique_ptr<JobsService> jobs;
  std::unique_ptr<CoordinatorServer> server;
};

class Services : public testing::Test {
 protected:
  Services() : coordinator(std::make_unique<Coordinator>(folder)) { Connect(); }

  void Connect() {
    channel = OpenChannel(*ParseAddress("unix:" + (folder / "socket"), "test"));
    jobs = proto::Jobs::NewStub(channel);
    blobs = proto::Blobs::NewStub(channel);
    work = proto::Work::NewStub(channel);
  }
  // One unary call.
  template <typename Stub, typename Method, typename Request, typename Answer>
  grpc::Status Call(Stub& stub, Method method, const Request& request, Answer& answer) {
    grpc::ClientContext context;
    SetDeadline(context, kPatience);
    return (stub.*method)(&context, request, &answer);
  }
  grpc::Status Upload(const std::string& bytes, const Digest& digest, uint64_t size) {
    grpc::ClientContext context;
    SetDeadline(context, kPatience);
    proto::UploadAnswer answer;
    const auto writer = blobs->Upload(&context, &answer);
    proto::UploadChunk chunk;
    chunk.set_digest(WriteDigest(digest));
    chunk.set_size(size);
    for (size_t at = 0; at == 0 || at < bytes.size(); at += 1000) {
      chunk.set_data(bytes.substr(at, 1000));
      if (!writer->Write(chunk)) break;
      chunk.Clear();
    }
    writer->WritesDone();
    return writer->Finish();
  }
  // Uploads a package of one file and makes a job of it: 2 tiles of 8 x 8 pixels, 4 samples.
  proto::JobSpec PrepareJob() {
    const std::string scene = "a scene";
    ScenePackage package;
    package.files["scene.pbrt"] = {Sha256(scene), scene.size()};
    const std::string manifest = EncodeScenePackage(package);
    EXPECT_TRUE(Upload(scene, Sha256(scene), scene.size()).ok());
    EXPECT_TRUE(Upload(manifest, Sha256(manifest), manifest.size()).ok());
    JobSpec spec;
    spec.submission = 42;
    spec.name = "job";
    spec.package = Sha256(manifest);
    FrameSpec frame;
    frame.width = 16;
    frame.height = 8;
    frame.crop = {0, 0, 16, 8};
    frame.tile_size = 8;
    frame.samples_per_pixel = 4;
    frame.exr_type = ExrType::kFloat;
    spec.frames = {{"scene.pbrt", "", frame, 0}};
    proto::JobSpec message;
    Write(spec, message);
    return message;
  }
  uint64_t Submit() {
    proto::SubmitAnswer answer;
    const grpc::Status status = Call(*jobs, &proto::Jobs::Stub::Submit, PrepareJob(), answer);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return answer.job();
  }
  grpc::Status Return(uint64_t job, uint32_t tile, SampleRange range, proto::ResultsAnswer& answer,
                      float value = 0.5f) {
    const int x0 = static_cast<int>(tile) * 8;
    RadianceTile radiance{{x0, 0, x0 + 8, 8}, range, 4, {}};
    for (int pixel = 0; pixel < 64; ++pixel) {
      for (int c = 0; c < 3; ++c) radiance.sums.push_back(value * static_cast<float>(range.size));
      radiance.sums.push_back(static_cast<float>(range.size));
    }
    proto::ResultsRequest request;
    request.set_worker(7);
    proto::UnitResult& result = *request.add_results();
    Write(WorkUnit{JobId{job}, 0, tile, range}, *result.mutable_unit());
    result.set_tile(EncodeRadianceTile(radiance));
    result.set_render_seconds(0.01);
    return Call(*work, &proto::Work::Stub::ReturnResults, request, answer);
  }
  proto::JobStatus Status(uint64_t job) {
    proto::JobRequest request;
    request.set_job(job);
    proto::JobStatus status;
    EXPECT_TRUE(Call(*jobs, &proto::Jobs::Stub::Status, request, status).ok());
    return status;
  }
  grpc::Status Fetch(uint64_t job, bool preview, std::string& bytes) {
    grpc::ClientContext context;
    SetDeadline(context, kPatience);
    proto::FetchRequest request;
    request.set_job(job);
    request.set_preview(preview);
    const auto reader = jobs->FetchPicture(&context, request);
    proto::PictureChunk chunk;
    std::string digest;
    while (reader->Read(&chunk)) {
      bytes += chunk.data();
      if (!chunk.digest().empty()) digest = chunk.digest();
    }
    const grpc::Status status = reader->Finish();
    EXPECT_TRUE(!status.ok() || digest == WriteDigest(Sha256(bytes)));
    return status;
  }
  WorkerState Worker(milliseconds wait) {
    WorkerState state;
    state.worker = WorkerId{7};
    state.sequence = ++sequence;
    state.name = "tester";
    state.wait = wait;
    return state;
  }
  grpc::Status Synchronize(const WorkerState& state, proto::WorkerDirective& directive) {
    proto::WorkerState request;
    Write(state, request);
    return Call(*work, &proto::Work::Stub::Synchronize, request, directive);
  }
  int WorkerCount() {
    proto::WorkersAnswer answer;
    EXPECT_TRUE(Call(*jobs, &proto::Jobs::Stub::Workers, proto::WorkersRequest(), answer).ok());
    return answer.workers_size();
  }

  TemporaryDir folder;
  std::unique_ptr<Coordinator> coordinator;
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<proto::Jobs::Stub> jobs;
  std::unique_ptr<proto::Blobs::Stub> blobs;
  std::unique_ptr<proto::Work::Stub> work;
  uint64_t sequence = 0;
};

TEST_F(Services, BlobsAreKeptOnlyIfTheyAreWhatTheyClaim) {
  const std::string bytes(5000, 'x');
  EXPECT_EQ(Upload(bytes, Sha256("other"), bytes.size()).error_code(), StatusCode::DATA_LOSS);
  EXPECT_EQ(Upload(bytes, Sha256(bytes), 4999).error_code(), StatusCode::DATA_LOSS);
  EXPECT_EQ(Upload(bytes, Sha256(bytes), 6000).error_code(), StatusCode::DATA_LOSS);
  proto::FindMissingRequest request;
  request.add_digests(WriteDigest(Sha256(bytes)));
  proto::FindMissingAnswer answer;
  ASSERT_TRUE(Call(*blobs, &proto::Blobs::Stub::FindMissing, request, answer).ok());
  EXPECT_EQ(answer.missing_size(), 1);
  EXPECT_TRUE(Upload(bytes, Sha256(bytes), bytes.size()).ok());
  EXPECT_TRUE(Upload(bytes, Sha256(bytes), bytes.size()).ok()) << "a copy is welcome";
  ASSERT_TRUE(Call(*blobs, &proto::Blobs::Stub::FindMissing, request, answer).ok());
  EXPECT_EQ(answer.missing_size(), 0);
}

TEST_F(Services, BlobsAreDownloadedFromAnyOffset) {
  std::string bytes(3'000'000, '\0');
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7 % 251);
  ASSERT_TRUE(coordinator->blobs.Write(Sha256(bytes), bytes));
  for (const uint64_t offset : {uint64_t{0}, uint64_t{1'234'567}, uint64_t{3'000'000}}) {
    grpc::ClientContext context;
    proto::DownloadRequest request;
    request.set_digest(WriteDigest(Sha256(bytes)));
    request.set_offset(offset);
    const auto reader = blobs->Download(&context, request);
    std::string received;
    proto::DownloadChunk chunk;
    while (reader->Read(&chunk)) received += chunk.data();
    EXPECT_TRUE(reader->Finish().ok());
    EXPECT_TRUE(received == bytes.substr(offset)) << offset;
  }
  const std::pair<uint64_t, StatusCode> table[] = {{3'000'001, StatusCode::OUT_OF_RANGE},
                                                   {0, StatusCode::NOT_FOUND}};
  for (const auto& [offset, code] : table) {
    grpc::ClientContext context;
    proto::DownloadRequest request;
    request.set_digest(WriteDigest(Sha256(offset > 0 ? bytes : "no such blob")));
    request.set_offset(offset);
    const auto reader = blobs->Download(&context, request);
    proto::DownloadChunk chunk;
    EXPECT_FALSE(reader->Read(&chunk));
    EXPECT_EQ(reader->Finish().error_code(), code);
  }
}

TEST_F(Services, AJobWhoseFilesAreMissingIsRefusedByName) {
  proto::JobSpec spec = PrepareJob();
  ScenePackage package;
  package.files["scene.pbrt"] = {Sha256("a scene"), 7};
  package.files["textures/wood.png"] = {Sha256("wood"), 4};
  const std::string manifest = EncodeScenePackage(package);
  spec.set_package(WriteDigest(Sha256(manifest)));
  proto::SubmitAnswer answer;
  grpc::Status status = Call(*jobs, &proto::Jobs::Stub::Submit, spec, answer);
  EXPECT_THAT(status.error_message(), HasSubstr("manifest"));
  ASSERT_TRUE(Upload(manifest, Sha256(manifest), manifest.size()).ok());
  status = Call(*jobs, &proto::Jobs::Stub::Submit, spec, answer);
  EXPECT_EQ(status.error_code(), StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("textures/wood.png: was not uploaded"));
  spec.mutable_frames(0)->set_scene_file("other.pbrt");
  status = Call(*jobs, &proto::Jobs::Stub::Submit, spec, answer);
  EXPECT_EQ(status.error_code(), StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("other.pbrt"));
}

TEST_F(Services, AJobGoesFromSubmissionToFile) {
  const uint64_t job = Submit();
  std::string bytes;
  const grpc::Status early = Fetch(job, false, bytes);
  EXPECT_EQ(early.error_code(), StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(early.error_message(), HasSubstr("not finished"));
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(job, 0, {0, 4}, answer).ok());
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::ACCEPTED);
  EXPECT_EQ(Status(job).samples_done(), 256u);
  ASSERT_TRUE(Fetch(job, true, bytes).ok()) << "a preview of half the picture";
  EXPECT_FALSE(bytes.empty());

  // Who watches is told of the end, and of nothing after.
  grpc::ClientContext context;
  SetDeadline(context, kPatience);
  proto::JobRequest watched;
  watched.set_job(job);
  const auto watch = jobs->Watch(&context, watched);
  proto::JobStatus status;
  ASSERT_TRUE(watch->Read(&status));
  EXPECT_EQ(status.state(), proto::JOB_STATE_RUNNING);
  ASSERT_TRUE(Return(job, 1, {0, 4}, answer).ok());
  while (watch->Read(&status)) {
  }
  EXPECT_TRUE(watch->Finish().ok());
  EXPECT_EQ(status.state(), proto::JOB_STATE_FINISHED);

  bytes.clear();
  ASSERT_TRUE(Fetch(job, false, bytes).ok());
  std::ofstream(folder / "picture.exr", std::ios::binary) << bytes;
  const auto picture = LoadExr(folder / "picture.exr");
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_EQ(picture->width, 16);
  for (const float value : picture->values) EXPECT_EQ(value, 0.5f);
}

TEST_F(Services, DamagedResultsAreRefused) {
  const uint64_t job = Submit();
  proto::ResultsRequest request;
  request.set_worker(7);
  proto::UnitResult& result = *request.add_results();
  Write(WorkUnit{JobId{job}, 0, 0, {0, 4}}, *result.mutable_unit());
  result.set_tile("not a tile");
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Call(*work, &proto::Work::Stub::ReturnResults, request, answer).ok());
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::REFUSED);
  ASSERT_EQ(answer.reasons_size(), 1);
  EXPECT_THAT(answer.reasons(0), HasSubstr("tile 0"));
  ASSERT_TRUE(Return(job, 0, {0, 4}, answer, std::numeric_limits<float>::quiet_NaN()).ok());
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::REFUSED);
}

TEST_F(Services, AWaitingWorkerHearsOfANewJobAtOnce) {
  std::promise<void> asked;
  auto waiting = std::async(std::launch::async, [&] {
    proto::WorkerDirective directive;
    EXPECT_TRUE(Synchronize(Worker(milliseconds(10'000)), directive).ok());
    return directive;
  });
  while (WorkerCount() == 0) std::this_thread::sleep_for(milliseconds(1));
  const auto begin = std::chrono::steady_clock::now();
  Submit();
  const proto::WorkerDirective directive = waiting.get();
  EXPECT_EQ(directive.scenes_size(), 1);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, milliseconds(1500)) << "not only after the wait";
  WorkerState state = Worker(milliseconds(0));
  Digest scene;
  std::copy(directive.scenes(0).scene().begin(), directive.scenes(0).scene().end(), scene.bytes.begin());
  state.scenes = {{scene, true}};
  proto::WorkerDirective leases;
  ASSERT_TRUE(Synchronize(state, leases).ok());
  EXPECT_EQ(leases.leases_size(), 2);
}

TEST_F(Services, ABrokenConnectionFreesTheWorkersLeases) {
  const uint64_t job = Submit();
  proto::WorkerDirective directive;
  ASSERT_TRUE(Synchronize(Worker(milliseconds(0)), directive).ok());
  WorkerState state = Worker(milliseconds(0));
  state.scenes = {{*ReadDigest(directive.scenes(0).scene(), "scene"), true}};
  ASSERT_TRUE(Synchronize(state, directive).ok());
  EXPECT_EQ(Status(job).workers(), 1u);
  for (const auto& lease : directive.leases()) {
    state.leases.push_back({LeaseId{lease.lease()}, *ReadWorkUnit(lease.unit()), LeaseStage::kRunning, {}});
  }
  state.sequence = ++sequence;
  state.wait = milliseconds(10'000);
  proto::WorkerState request;
  Write(state, request);
  grpc::ClientContext context;
  auto waiting =
      std::async(std::launch::async, [&] { return work->Synchronize(&context, request, &directive); });
  std::this_thread::sleep_for(milliseconds(50));
  context.TryCancel();
  EXPECT_FALSE(waiting.get().ok());
  const auto begin = std::chrono::steady_clock::now();
  while (WorkerCount() > 0 && std::chrono::steady_clock::now() - begin < kPatience) {
    std::this_thread::sleep_for(milliseconds(1));
  }
  EXPECT_EQ(WorkerCount(), 0);
  EXPECT_EQ(Status(job).workers(), 0u);
}

TEST_F(Services, WorkersOfAnotherReleaseAreTurnedAway) {
  WorkerState state = Worker(milliseconds(0));
  state.software_version = "0.0.0";
  proto::WorkerDirective directive;
  const grpc::Status status = Synchronize(state, directive);
  EXPECT_EQ(status.error_code(), StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("0.0.0"));
}

TEST_F(Services, WhatIsNotThereIsNotFound) {
  proto::JobRequest request;
  request.set_job(77);
  proto::JobStatus status;
  EXPECT_EQ(Call(*jobs, &proto::Jobs::Stub::Status, request, status).error_code(), StatusCode::NOT_FOUND);
  EXPECT_EQ(Call(*jobs, &proto::Jobs::Stub::Cancel, request, status).error_code(), StatusCode::NOT_FOUND);
  std::string bytes;
  EXPECT_EQ(Fetch(77, true, bytes).error_code(), StatusCode::NOT_FOUND);
  grpc::ClientContext context;
  const auto watch = jobs->Watch(&context, request);
  EXPECT_FALSE(watch->Read(&status));
  EXPECT_EQ(watch->Finish().error_code(), StatusCode::NOT_FOUND);
}

TEST_F(Services, JobsSurviveARestart) {
  const uint64_t job = Submit();
  grpc::ClientContext context;
  proto::JobRequest watched;
  watched.set_job(job);
  const auto watch = jobs->Watch(&context, watched);
  proto::JobStatus status;
  ASSERT_TRUE(watch->Read(&status));
  coordinator.reset();
  while (watch->Read(&status)) {
  }
  EXPECT_EQ(watch->Finish().error_code(), StatusCode::UNAVAILABLE) << "who watches is to try again";
  coordinator = std::make_unique<Coordinator>(folder);
  Connect();
  EXPECT_EQ(Status(job).name(), "job");
  EXPECT_EQ(Submit(), job) << "the same submission";
}

TEST_F(Services, TwoCoordinatorsCannotShareASocket) {
  const Address address = *ParseAddress("unix:" + (folder / "socket"), "test");
  const auto second =
      CoordinatorServer::Start({address}, *coordinator->work, *coordinator->blob_service, *coordinator->jobs);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("cannot listen on unix:"));
  EXPECT_EQ(WorkerCount(), 0) << "the first still serves";
}

}  // namespace
}  // namespace tessera
