// A coordinator over real gRPC on a Unix socket, and the calls that clients and workers make.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/coordinator.h"
#include "proto/blobs.grpc.pb.h"
#include "proto/jobs.grpc.pb.h"
#include "proto/probe.h"
#include "proto/scene_package.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "proto/work.grpc.pb.h"
#include "renderer/film/radiance_tile.h"
#include "tests/coordinator/core/schedule/former_lease.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/sanitizers.h"

namespace tessera {
using std::chrono::milliseconds;

constexpr milliseconds kPatience{kSlowdown * 20'000};

// Whether a condition comes true: what others do takes a moment.
template <typename Condition>
bool ComesTrue(const Condition& condition, milliseconds patience = kPatience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return true;
}

class Services : public testing::Test {
 protected:
  // The coordinator has run before, so results of leases that are not known to it may be its own.
  explicit Services(AccessPolicy policy = AdmitByRole) {
    Start(policy);
    coordinator.reset();
    Start(std::move(policy));
  }

  CoordinatorOptions OptionsOf(const std::string& data_dir) const {
    CoordinatorOptions options;
    options.listen = {*ParseAddress("unix:" + (folder / "socket"), "test")};
    for (const std::string& each : more_addresses) options.listen.push_back(*ParseAddress(each, "test"));
    options.http = http;
    options.https = https;
    options.data_dir = folder / data_dir;
    return options;
  }
  // Starts the coordinator and connects to it.
  void Start(AccessPolicy policy = AdmitByRole) {
    coordinator = std::move(*Coordinator::Start(OptionsOf(current_dir), std::move(policy)));
    channel = OpenChannel(coordinator->addresses().front());
    jobs = proto::Jobs::NewStub(channel);
    blobs = proto::Blobs::NewStub(channel);
    work = proto::Work::NewStub(channel);
    farm = {};
  }
  // Sets `farm` as a worker learns it.
  void LearnFarm() {
    if (farm != FarmId{}) return;
    proto::WorkerDirective directive;
    WorkerState state;
    state.worker = WorkerId{99};
    state.probe_digest = ProbeDigest();
    state.leaving = true;
    const grpc::Status status = Synchronize(state, directive);
    if (status.ok()) farm = *ReadFarmId(directive.farm());
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
    scene_key = SceneKey(spec.package, "scene.pbrt", "", frame);
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
    RadianceTile radiance{{x0, 0, x0 + 8, 8}, range, {4}, {}};
    for (int pixel = 0; pixel < 64; ++pixel) {
      for (int c = 0; c < 3; ++c) radiance.sums.push_back(value * static_cast<float>(range.size));
      radiance.sums.push_back(static_cast<float>(range.size));
    }
    return Return(ResultOf(job, tile, range, EncodeRadianceTile(radiance)), answer);
  }
  proto::ResultsRequest ResultOf(uint64_t job, uint32_t tile, SampleRange range,
                                 const std::string& encoded) const {
    proto::ResultsRequest request;
    proto::UnitResult& result = *request.add_results();
    Write(WorkUnit{JobId{job}, 0, tile, range, scene_key}, *result.mutable_unit());
    Write(FormerLease(), *result.mutable_lease());
    result.set_tile(encoded);
    result.set_render_seconds(0.01);
    return request;
  }
  // The worker lists the leases of the results first.
  grpc::Status Return(const proto::ResultsRequest& results, proto::ResultsAnswer& answer) {
    WorkerState state = Worker(milliseconds(0));
    for (const proto::UnitResult& each : results.results())
      state.leases.push_back({FormerLease(), *ReadWorkUnit(each.unit()), LeaseStage::kRunning, {}});
    proto::WorkerDirective directive;
    EXPECT_TRUE(Synchronize(state, directive).ok());
    return Return(Announcement(WorkerId{7}, farm, results), results, answer);
  }
  grpc::Status Return(const proto::ResultsRequest& announcement, const proto::ResultsRequest& results,
                      proto::ResultsAnswer& answer) {
    grpc::ClientContext context;
    SetDeadline(context, kPatience);
    const auto writer = work->ReturnResults(&context, &answer);
    if (writer->Write(announcement)) writer->WriteLast(results, {});
    return writer->Finish();
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
  static std::string ProbeDigest() {
    const Digest digest = *Digest::FromHex(kProbeDigest);
    return {digest.bytes.begin(), digest.bytes.end()};
  }
  WorkerState Worker(milliseconds wait) {
    LearnFarm();
    WorkerState state;
    state.worker = WorkerId{7};
    state.sequence = ++sequence;
    state.name = "tester";
    state.farm = farm;
    state.wait = wait;
    state.probe_digest = ProbeDigest();
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
  std::string current_dir = "data";  // that Start uses
  std::vector<std::string> more_addresses;
  std::optional<Address> http, https;  // of the web page
  FarmId farm;
  Digest scene_key;  // of the prepared job
  uint64_t sequence = 0;
};

}  // namespace tessera
