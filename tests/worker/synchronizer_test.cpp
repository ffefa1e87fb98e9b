// The exchange of states over a real connection.
#include "worker/synchronizer.h"

#include <grpcpp/channel.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "proto/wire/address.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "proto/work.grpc.pb.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kPatience{30};

// A coordinator that never answers: its calls wait until they are cancelled.
class SilentCoordinator final : public proto::Work::CallbackService {
 public:
  explicit SilentCoordinator(const Address& address) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address.Target(), grpc::InsecureServerCredentials());
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~SilentCoordinator() override { server_->Shutdown(); }

  grpc::ServerUnaryReactor* Synchronize(grpc::CallbackServerContext*, const proto::WorkerState* state,
                                        proto::WorkerDirective*) override {
    const std::lock_guard lock(mutex_);
    wait_ms_ = state->wait_ms();
    ++calls_;
    called_.notify_all();
    return new Waiting;
  }
  bool AwaitCalls(int count) {
    std::unique_lock lock(mutex_);
    return called_.wait_for(lock, kPatience, [&] { return calls_ >= count; });
  }

  // How long the last call asked to be kept waiting for news.
  int64_t wait_ms() {
    const std::lock_guard lock(mutex_);
    return wait_ms_;
  }

 private:
  struct Waiting final : grpc::ServerUnaryReactor {
    void OnCancel() override { Finish(grpc::Status::CANCELLED); }
    void OnDone() override { delete this; }
  };
  std::mutex mutex_;
  std::condition_variable called_;
  int calls_ = 0;
  int64_t wait_ms_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

// A farm that is full until it is told otherwise.
class FullFarm final : public proto::Work::Service {
 public:
  explicit FullFarm(const Address& address) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address.Target(), grpc::InsecureServerCredentials());
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~FullFarm() override { server_->Shutdown(std::chrono::system_clock::now()); }
  grpc::Status Synchronize(grpc::ServerContext*, const proto::WorkerState*,
                           proto::WorkerDirective* answer) override {
    ++calls_;
    if (is_full) return {grpc::StatusCode::RESOURCE_EXHAUSTED, "the farm is full"};
    answer->set_farm(WriteFarmId({1, 2}));
    answer->set_call_again_ms(10'000);
    has_joined = true;
    return grpc::Status::OK;
  }
  int calls() const { return calls_; }
  std::atomic<bool> is_full = true, has_joined = false;

 private:
  std::atomic<int> calls_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

TEST(Synchronizer, TriesSeldomToJoinAFarmThatIsFullAndJoinsItWhenThereIsPlace) {
  const TemporaryDir folder;
  const Address address = *ParseAddress("unix:" + (folder / "socket"), "test");
  FullFarm farm(address);
  const auto cache = BlobStore::Open(folder / "cache", BlobStoreOptions::Cache(1 << 20));
  const std::shared_ptr<grpc::Channel> channel = OpenChannel(address);
  BlobFetcher fetcher(channel, *cache, {}, 1, [](uint64_t) {});
  Prefetcher prefetcher(fetcher);
  ActivityMeter meter(1, std::chrono::steady_clock::now());
  SharedWorkload workload([] {});
  WorkerState self;
  self.worker = WorkerId{1};
  std::atomic<bool> is_refused = false;
  Synchronizer synchronizer(channel, address, self, workload, meter, prefetcher,
                            [&](const Error&) { is_refused = true; });
  std::jthread exchange([&](std::stop_token stop) { synchronizer.Run(std::move(stop)); });
  std::this_thread::sleep_for(std::chrono::seconds(4));
  EXPECT_GE(farm.calls(), 2);
  EXPECT_LE(farm.calls(), 4) << "after half a second to a second, then twice as long each time";
  farm.is_full = false;
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!farm.has_joined && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(farm.has_joined);
  EXPECT_FALSE(is_refused);
}

TEST(Synchronizer, AsksForAnImmediateAnswerUntilItIsConnected) {
  const TemporaryDir folder;
  const Address address = *ParseAddress("unix:" + (folder / "socket"), "test");
  SilentCoordinator coordinator(address);
  const auto cache = BlobStore::Open(folder / "cache", BlobStoreOptions::Cache(1 << 20));
  const std::shared_ptr<grpc::Channel> channel = OpenChannel(address);
  BlobFetcher fetcher(channel, *cache, {}, 1, [](uint64_t) {});
  Prefetcher prefetcher(fetcher);
  ActivityMeter meter(1, std::chrono::steady_clock::now());
  SharedWorkload workload([] {});
  WorkerState self;
  self.worker = WorkerId{1};
  Synchronizer synchronizer(channel, address, self, workload, meter, prefetcher, [](const Error&) {});
  std::jthread exchange([&](std::stop_token stop) { synchronizer.Run(std::move(stop)); });
  ASSERT_TRUE(coordinator.AwaitCalls(1));
  EXPECT_EQ(coordinator.wait_ms(), 0);
}

// The last owner of a channel waits for gRPC's threads to end; one of those threads would wait for itself.
TEST(Synchronizer, NeverLeavesItsChannelToAThreadOfGrpc) {
  const TemporaryDir folder;
  const Address address = *ParseAddress("unix:" + (folder / "socket"), "test");
  SilentCoordinator coordinator(address);
  const auto cache = BlobStore::Open(folder / "cache", BlobStoreOptions::Cache(1 << 20));
  for (int round = 1; round <= 50; ++round) {
    const std::shared_ptr<grpc::Channel> channel = OpenChannel(address);
    {
      BlobFetcher fetcher(channel, *cache, {}, 1, [](uint64_t) {});
      Prefetcher prefetcher(fetcher);
      ActivityMeter meter(1, std::chrono::steady_clock::now());
      SharedWorkload workload([] {});
      WorkerState self;
      self.worker = WorkerId{static_cast<uint64_t>(round)};
      Synchronizer synchronizer(channel, address, self, workload, meter, prefetcher, [](const Error&) {});
      std::jthread exchange([&](std::stop_token stop) { synchronizer.Run(std::move(stop)); });
      ASSERT_TRUE(coordinator.AwaitCalls(round));
    }
    ASSERT_EQ(channel.use_count(), 1) << "round " << round;
  }
}

}  // namespace
}  // namespace tessera
