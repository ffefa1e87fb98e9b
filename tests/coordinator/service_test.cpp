// The services for jobs and workers, called as clients and workers do.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <future>
#include <thread>

#include "renderer/film/picture_file.h"
#include "tests/coordinator/services_fixture.h"

namespace tessera {
namespace {

using grpc::StatusCode;
using testing::HasSubstr;

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

TEST_F(Services, AJobThatCannotBeDenoisedAsItAsksForIsRefused) {
  proto::JobSpec job = PrepareJob();
  job.mutable_frames(0)->mutable_spec()->set_denoiser(1);
  proto::SubmitAnswer answer;
  const grpc::Status refused = Call(*jobs, &proto::Jobs::Stub::Submit, job, answer);
  EXPECT_EQ(refused.error_code(), StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(refused.error_message(),
              HasSubstr("scene.pbrt: cannot be denoised without the layers albedo, normal, depth, halves"));
  job.mutable_frames(0)->mutable_spec()->set_denoiser(77);
  EXPECT_EQ(Call(*jobs, &proto::Jobs::Stub::Submit, job, answer).error_code(), StatusCode::INVALID_ARGUMENT);
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

  // A watcher receives the last status, and nothing after it.
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

TEST_F(Services, AWatcherLearnsThatAJobWasExtendedBeforeItsNextSample) {
  proto::JobSpec spec = PrepareJob();
  spec.mutable_frames(0)->set_extendable(true);
  proto::SubmitAnswer submitted;
  ASSERT_TRUE(Call(*jobs, &proto::Jobs::Stub::Submit, spec, submitted).ok());
  grpc::ClientContext context;
  SetDeadline(context, kPatience);
  proto::JobRequest watched;
  watched.set_job(submitted.job());
  const auto watch = jobs->Watch(&context, watched);
  proto::JobStatus status;
  ASSERT_TRUE(watch->Read(&status));
  EXPECT_EQ(status.samples_total(), 512u);
  proto::ExtendRequest extend;
  extend.set_job(submitted.job());
  extend.set_samples_per_pixel(8);
  proto::JobStatus extended;
  const grpc::Status changed = Call(*jobs, &proto::Jobs::Stub::Extend, extend, extended);
  ASSERT_TRUE(changed.ok()) << changed.error_message();
  ASSERT_TRUE(watch->Read(&status));
  EXPECT_EQ(status.samples_total(), 1024u);
  context.TryCancel();
  watch->Finish();
}

TEST_F(Services, MalformedResultsAreRefused) {
  const uint64_t job = Submit();
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(ResultOf(job, 0, {0, 4}, "not a tile"), answer).ok());
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::REFUSED);
  ASSERT_EQ(answer.reasons_size(), 1);
  EXPECT_THAT(answer.reasons(0), HasSubstr("tile 0"));
  ASSERT_TRUE(Return(job, 0, {0, 4}, answer, std::numeric_limits<float>::quiet_NaN()).ok());
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::REFUSED);
}

TEST_F(Services, AWaitingWorkerLearnsOfANewJobImmediately) {
  std::promise<void> asked;
  auto waiting = std::async(std::launch::async, [&] {
    proto::WorkerDirective directive;
    EXPECT_TRUE(Synchronize(Worker(milliseconds(10'000)), directive).ok());
    return directive;
  });
  ASSERT_TRUE(ComesTrue([&] { return WorkerCount() == 1; }));
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

TEST_F(Services, ABrokenConnectionReturnsTheLeasesOfTheWorker) {
  const uint64_t job = Submit();
  proto::WorkerDirective directive;
  ASSERT_TRUE(Synchronize(Worker(milliseconds(0)), directive).ok());
  WorkerState state = Worker(milliseconds(0));
  state.scenes = {{*ReadDigest(directive.scenes(0).scene(), "scene"), true}};
  ASSERT_TRUE(Synchronize(state, directive).ok());
  EXPECT_EQ(Status(job).workers(), 1u);
  for (const auto& lease : directive.leases()) {
    state.leases.push_back(
        {ReadLeaseId(lease.lease()), *ReadWorkUnit(lease.unit()), LeaseStage::kRunning, {}});
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
  EXPECT_TRUE(ComesTrue([&] { return WorkerCount() == 0; }));
  EXPECT_EQ(Status(job).workers(), 0u);
}

TEST_F(Services, WorkersOfAnotherReleaseAreRefused) {
  WorkerState state = Worker(milliseconds(0));
  state.software_version = "0.0.0";
  proto::WorkerDirective directive;
  const grpc::Status status = Synchronize(state, directive);
  EXPECT_EQ(status.error_code(), StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("0.0.0"));
}

// What its state holds besides may mean something else there.
TEST_F(Services, AWorkerOfAnotherProtocolIsRefusedWithBothNumbersAndHasNotJoined) {
  for (const uint32_t protocol : {kProtocolVersion - 1, kProtocolVersion + 1}) {
    WorkerState state = Worker(milliseconds(0));
    state.protocol = protocol;
    state.software_version = "";
    proto::WorkerState request;
    Write(state, request);
    request.add_leases();
    request.add_preparations("no digest");
    request.set_machine(~uint64_t{0});
    proto::WorkerDirective directive;
    const grpc::Status status = Call(*work, &proto::Work::Stub::Synchronize, request, directive);
    EXPECT_EQ(status.error_code(), StatusCode::FAILED_PRECONDITION) << "it never can";
    EXPECT_EQ(status.error_message(),
              fmt::format("worker \"tester\" uses protocol {}, this coordinator {}; install the same "
                          "release on both",
                          protocol, kProtocolVersion));
    EXPECT_EQ(WorkerCount(), 0);
  }
}

// Programs of all releases compare these members by their numbers, and a name in the answer to a worker.
TEST_F(Services, TheMembersByWhichReleasesAreComparedKeepTheirNumbers) {
  proto::HealthAnswer health;
  ASSERT_TRUE(Call(*jobs, &proto::Jobs::Stub::Health, proto::HealthRequest(), health).ok());
  const std::string version = kSoftwareVersion;
  const std::string members = std::string("\x0a") + static_cast<char>(version.size()) + version + "\x10" +
                              static_cast<char>(kProtocolVersion);
  EXPECT_EQ(health.SerializeAsString().substr(0, members.size()), members);
  proto::WorkerState state;
  ASSERT_TRUE(state.ParseFromString("\b\7\020\5\"\5blade2\0030.1"));
  EXPECT_EQ(state.protocol(), 7u);
  EXPECT_EQ(state.worker(), 5u);
  EXPECT_EQ(state.name(), "blade");
  EXPECT_EQ(state.software_version(), "0.1");
}

TEST_F(Services, AWorkerThatHasNotRenderedTheProbeIsRefused) {
  WorkerState state = Worker(milliseconds(0));
  state.probe_digest.clear();
  proto::WorkerDirective directive;
  const grpc::Status status = Synchronize(state, directive);
  EXPECT_EQ(status.error_code(), StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("probe"));
}

TEST_F(Services, WhatAWorkerReturnsBeforeItJoinsIsToBeSentAgain) {
  const uint64_t job = Submit();
  LearnFarm();
  const proto::ResultsRequest results = ResultOf(job, 0, {0, 4}, "a tile");
  proto::ResultsAnswer answer;
  EXPECT_EQ(Return(Announcement(WorkerId{7}, farm, results), results, answer).error_code(),
            StatusCode::UNAVAILABLE);
  proto::FailureRequest failure;
  failure.set_worker(7);
  failure.set_farm(WriteFarmId(farm));
  failure.set_scene(WriteDigest(Sha256("a scene")));
  proto::FailureAnswer answered;
  EXPECT_EQ(Call(*work, &proto::Work::Stub::ReturnFailure, failure, answered).error_code(),
            StatusCode::UNAVAILABLE);
}

TEST_F(Services, AResultThatNobodyAskedTheWorkerForIsNotMerged) {
  const uint64_t job = Submit();
  proto::WorkerDirective directive;
  ASSERT_TRUE(Synchronize(Worker(milliseconds(0)), directive).ok());
  proto::ResultsRequest results = ResultOf(job, 0, {0, 4}, "a tile");
  Write(LeaseId{12345, 7}, *results.mutable_results(0)->mutable_lease());
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(Announcement(WorkerId{7}, farm, results), results, answer).ok());
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::OBSOLETE);
  EXPECT_EQ(Status(job).samples_done(), 0u);
}

TEST_F(Services, UnknownJobsAreNotFound) {
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

TEST_F(Services, AWatcherThatCancelsIsForgottenThoughTheStatusDoesNotChange) {
  proto::JobRequest watched;
  watched.set_job(Submit());
  const auto comes_to = [&](size_t count) {
    return ComesTrue([&] { return coordinator->watcher_count() == count; });
  };
  grpc::ClientContext staying, leaving;
  const auto stays = jobs->Watch(&staying, watched);
  const auto leaves = jobs->Watch(&leaving, watched);
  proto::JobStatus status;
  ASSERT_TRUE(stays->Read(&status));
  ASSERT_TRUE(leaves->Read(&status));
  ASSERT_TRUE(comes_to(2));
  leaving.TryCancel();
  EXPECT_EQ(leaves->Finish().error_code(), StatusCode::CANCELLED);
  EXPECT_TRUE(comes_to(1)) << coordinator->watcher_count();
  staying.TryCancel();
  EXPECT_EQ(stays->Finish().error_code(), StatusCode::CANCELLED);
  EXPECT_TRUE(comes_to(0));
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
  EXPECT_EQ(watch->Finish().error_code(), StatusCode::UNAVAILABLE) << "watchers try again";
  Start();
  EXPECT_EQ(Status(job).name(), "job");
  EXPECT_EQ(Submit(), job) << "the same submission";
}

TEST_F(Services, AFarmKeepsItsIdentityAndEachDirectoryHasItsOwn) {
  LearnFarm();
  const FarmId first = farm;
  EXPECT_NE(first, FarmId{});
  coordinator.reset();
  Start();
  LearnFarm();
  EXPECT_EQ(farm, first);
  coordinator.reset();
  current_dir = "other";
  Start();
  LearnFarm();
  EXPECT_NE(farm, first);
  EXPECT_NE(farm, FarmId{});
}

TEST_F(Services, ResultsAndFailuresOfAnotherFarmChangeNothing) {
  const uint64_t job = Submit();
  proto::WorkerDirective directive;
  ASSERT_TRUE(Synchronize(Worker(milliseconds(0)), directive).ok());
  farm.low ^= 1;
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(job, 0, {0, 4}, answer).ok());
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::OBSOLETE);
  EXPECT_EQ(Status(job).samples_done(), 0u);
  proto::FailureRequest failure;
  failure.set_worker(7);
  failure.set_farm(WriteFarmId(farm));
  failure.set_farm(WriteFarmId(farm));
  failure.set_scene(WriteDigest(scene_key));
  failure.set_reason("another farm's");
  proto::FailureAnswer acknowledged;
  for (int i = 0; i < 5; ++i)
    ASSERT_TRUE(Call(*work, &proto::Work::Stub::ReturnFailure, failure, acknowledged).ok());
  EXPECT_NE(acknowledged.farm(), failure.farm());
  EXPECT_NE(Status(job).state(), proto::JOB_STATE_FAILED);
}

TEST_F(Services, TwoCoordinatorsCannotShareASocket) {
  const auto second = Coordinator::Start(OptionsOf("other-data"));
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("cannot listen on unix:"));
  EXPECT_EQ(WorkerCount(), 0) << "the first still serves";
}

}  // namespace
}  // namespace tessera
