// The exchange of states over a real connection.
#include "worker/synchronizer.h"

#include <grpcpp/channel.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

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

// A farm that is full as long as `is_full`, or that gives another answer to workers that want to join.
class FullFarm final : public proto::Work::Service {
 public:
  explicit FullFarm(const Address& address,
                    grpc::Status refusal = {grpc::StatusCode::RESOURCE_EXHAUSTED, "the farm is full"})
      : refusal_(std::move(refusal)) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address.Target(), grpc::InsecureServerCredentials());
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~FullFarm() override { server_->Shutdown(std::chrono::system_clock::now()); }
  grpc::Status Synchronize(grpc::ServerContext*, const proto::WorkerState*,
                           proto::WorkerDirective* answer) override {
    {
      const std::lock_guard lock(mutex_);
      calls_.push_back(std::chrono::steady_clock::now());
    }
    changed_.notify_all();
    if (is_full) return refusal_;
    answer->set_farm(WriteFarmId({1, 2}));
    answer->set_call_again_ms(10'000);
    {
      const std::lock_guard lock(mutex_);
      has_joined_ = true;
    }
    changed_.notify_all();
    return grpc::Status::OK;
  }
  // Waits for `count` calls. Returns when each has arrived.
  std::vector<std::chrono::steady_clock::time_point> AwaitCalls(size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kPatience, [&] { return calls_.size() >= count; });
    return calls_;
  }
  bool AwaitJoin() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return has_joined_; });
  }
  std::atomic<bool> is_full = true;

 private:
  const grpc::Status refusal_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::chrono::steady_clock::time_point> calls_;
  bool has_joined_ = false;
  std::unique_ptr<grpc::Server> server_;
};

// A synchronizer and what it needs, running as long as it lives.
class RunningSynchronizer {
 public:
  RunningSynchronizer(const std::shared_ptr<grpc::Channel>& channel, const Address& address, uint64_t worker,
                      const BlobStore& cache)
      : fetcher_(channel, cache, {}, 1, [](uint64_t) {}),
        prefetcher_(fetcher_),
        self_(StateOf(worker)),
        synchronizer_(channel, address, self_, workload_, meter_, prefetcher_,
                      [this](const Error& error) {
                        if (is_refused) return;  // only the first reason is read
                        refusal = error.message;
                        is_refused = true;
                        is_refused.notify_all();
                      }),
        exchange_([this](std::stop_token stop) { synchronizer_.Run(std::move(stop)); }) {}

  std::atomic<bool> is_refused = false;
  std::string refusal;  // once it is refused

 private:
  static WorkerState StateOf(uint64_t worker) {
    WorkerState state;
    state.worker = WorkerId{worker};
    return state;
  }

  BlobFetcher fetcher_;
  Prefetcher prefetcher_;
  ActivityMeter meter_{1, std::chrono::steady_clock::now()};
  SharedWorkload workload_{[] {}};
  WorkerState self_;
  Synchronizer synchronizer_;
  std::jthread exchange_;
};

TEST(Synchronizer, TriesSeldomToJoinAFarmThatIsFullAndJoinsItWhenThereIsPlace) {
  const TemporaryDir folder;
  const Address address = *ParseAddress("unix:" + (folder / "socket"), "test");
  FullFarm farm(address);
  const auto cache = BlobStore::Open(folder / "cache", BlobStoreOptions::Cache(1 << 20));
  const RunningSynchronizer synchronizer(OpenChannel(address), address, 1, *cache);
  const auto calls = farm.AwaitCalls(3);
  ASSERT_GE(calls.size(), 3u);
  EXPECT_GE(calls[1] - calls[0], std::chrono::milliseconds(500)) << "after half a second to a second";
  EXPECT_GE(calls[2] - calls[1], std::chrono::seconds(1)) << "then twice as long each time";
  farm.is_full = false;
  EXPECT_TRUE(farm.AwaitJoin());
  EXPECT_FALSE(synchronizer.is_refused);
}

// Of an older worker, a newer coordinator reads the protocol alone.
TEST(Synchronizer, EndsWithTheReasonOfACoordinatorOfAnotherRelease) {
  const TemporaryDir folder;
  const Address address = *ParseAddress("unix:" + (folder / "socket"), "test");
  const std::string reason =
      "worker \"w\" uses protocol 8, this coordinator 9; install the same release on both";
  const FullFarm farm(address, {grpc::StatusCode::FAILED_PRECONDITION, reason});
  const auto cache = BlobStore::Open(folder / "cache", BlobStoreOptions::Cache(1 << 20));
  const RunningSynchronizer synchronizer(OpenChannel(address), address, 1, *cache);
  synchronizer.is_refused.wait(false);
  EXPECT_EQ(synchronizer.refusal, "cannot join the farm: " + reason);
}

TEST(Synchronizer, AsksForAnImmediateAnswerUntilItIsConnected) {
  const TemporaryDir folder;
  const Address address = *ParseAddress("unix:" + (folder / "socket"), "test");
  SilentCoordinator coordinator(address);
  const auto cache = BlobStore::Open(folder / "cache", BlobStoreOptions::Cache(1 << 20));
  const RunningSynchronizer synchronizer(OpenChannel(address), address, 1, *cache);
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
      const RunningSynchronizer synchronizer(channel, address, static_cast<uint64_t>(round), *cache);
      ASSERT_TRUE(coordinator.AwaitCalls(round));
    }
    ASSERT_EQ(channel.use_count(), 1) << "round " << round;
  }
}

}  // namespace
}  // namespace tessera
