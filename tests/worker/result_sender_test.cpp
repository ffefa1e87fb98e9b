#include "worker/result_sender.h"

#include <grpcpp/channel.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "proto/wire/address.h"
#include "proto/wire/channel.h"
#include "proto/work.grpc.pb.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/worker/tiny_scene.h"

namespace tessera {
namespace {

using namespace std::chrono_literals;
using Clock = SharedWorkload::Clock;

// Refuses all failures, and results with one tile, as a coordinator does that cannot take them.
class PickyCoordinator final : public proto::Work::Service {
 public:
  explicit PickyCoordinator(const Address& address) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address.Target(), grpc::InsecureServerCredentials());
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~PickyCoordinator() override { server_->Shutdown(std::chrono::system_clock::now() + 1s); }
  // Waits until these tiles have been accepted.
  bool Await(const std::set<std::string>& tiles) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 20s, [&] { return accepted_ == tiles; });
  }

 private:
  grpc::Status ReturnResults(grpc::ServerContext*, grpc::ServerReader<proto::ResultsRequest>* reader,
                             proto::ResultsAnswer* answer) override {
    proto::ResultsRequest request;
    std::set<std::string> tiles;
    while (reader->Read(&request)) {
      for (const auto& result : request.results()) {
        if (result.tile() == "refused") return {grpc::StatusCode::RESOURCE_EXHAUSTED, "too large"};
        tiles.insert(result.tile());
        answer->add_verdicts(proto::ResultsAnswer::ACCEPTED);
      }
    }
    const std::lock_guard lock(mutex_);
    accepted_.merge(tiles);
    changed_.notify_all();
    return grpc::Status::OK;
  }
  grpc::Status ReturnFailure(grpc::ServerContext*, const proto::FailureRequest*,
                             proto::FailureAnswer*) override {
    return {grpc::StatusCode::INTERNAL, "the request is not valid UTF-8"};
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string> accepted_;
  std::unique_ptr<grpc::Server> server_;
};

TEST(ResultSender, WhatIsRefusedDoesNotDelayWhatComesAfterIt) {
  const TemporaryDir folder;
  const Address address = *ParseAddress("unix:" + (folder / "socket"), "test");
  PickyCoordinator coordinator(address);
  BlobMap blobs;
  const SceneRequest order = MakeOrder(blobs, kTinyScene);
  SharedWorkload workload([] {});
  workload.Change()->Apply({{order}, {}, {}, {}, {}, {}, {}}, Clock::now());
  const auto task = workload.AwaitLoaderTask({});
  const auto* const started = std::get_if<SceneRequest>(&*task);
  workload.Change()->SceneLoaded(started->key, *LoadOrderedScene(*started, blobs.Fetcher()));
  uint64_t id = 0;
  for (const char* tile : {"refused", "first", "second"}) {
    const Lease lease{LeaseId{++id}, {JobId{1}, 0, 0, {0, 4}, order.key}, {0, 0, 8, 8}, {}, 3000ms};
    workload.Change()->AddLeases({}, {lease}, {}, Clock::now());
    const auto task = workload.AwaitUnit({});
    workload.Change()->UnitFinished({task->lease.id, task->lease.unit, tile, 0.1}, Clock::now());
  }
  workload.Change()->SceneFailed(Sha256("another"), "it cannot be delivered", FailureCause::kScene,
                                 Clock::now());
  ResultSender sender(OpenChannel(address), WorkerId{1}, workload);
  std::jthread thread([&](std::stop_token stop) { sender.Run(std::move(stop)); });
  EXPECT_TRUE(coordinator.Await({"first", "second"}));
}

}  // namespace
}  // namespace tessera
