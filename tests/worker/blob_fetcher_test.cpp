// Downloads from coordinators that refuse, stall or break off.
#include "worker/blob_fetcher.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <grpcpp/channel.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <deque>
#include <mutex>
#include <thread>

#include "proto/blobs.grpc.pb.h"
#include "proto/wire/address.h"
#include "proto/wire/channel.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr FetchPatience kImpatient{300ms, 20s};

// Answers downloads as a script says, the last step again and again.
class ScriptedBlobs final : public proto::Blobs::Service {
 public:
  enum class Step { kRefuse, kAway, kStall, kHalf, kServe, kEmpty, kMissing };
  ScriptedBlobs(const Address& address, std::string bytes, std::deque<Step> script)
      : bytes_(std::move(bytes)), script_(std::move(script)) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address.Target(), grpc::InsecureServerCredentials());
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~ScriptedBlobs() override { server_->Shutdown(std::chrono::system_clock::now() + 1s); }
  int calls() {
    const std::lock_guard lock(mutex_);
    return calls_;
  }

 private:
  grpc::Status Download(grpc::ServerContext* context, const proto::DownloadRequest* request,
                        grpc::ServerWriter<proto::DownloadChunk>* writer) override {
    switch (NextStep()) {
      case Step::kRefuse: return {grpc::StatusCode::RESOURCE_EXHAUSTED, "too many transfers"};
      case Step::kAway: return {grpc::StatusCode::UNAVAILABLE, "too many transfers; try again"};
      case Step::kMissing: return {grpc::StatusCode::NOT_FOUND, "there is no such blob"};
      case Step::kStall:
        while (!context->IsCancelled()) std::this_thread::sleep_for(5ms);
        return grpc::Status::CANCELLED;
      case Step::kHalf: Send(*writer, request->offset(), bytes_.size() / 2); return grpc::Status::OK;
      case Step::kServe: Send(*writer, request->offset(), bytes_.size()); return grpc::Status::OK;
      case Step::kEmpty:
        while (!context->IsCancelled()) Send(*writer, 0, 0);
        return grpc::Status::CANCELLED;
    }
    return grpc::Status::CANCELLED;
  }
  Step NextStep() {
    const std::lock_guard lock(mutex_);
    ++calls_;
    const Step step = script_.front();
    if (script_.size() > 1) script_.pop_front();
    return step;
  }
  void Send(grpc::ServerWriter<proto::DownloadChunk>& writer, uint64_t from, uint64_t to) const {
    proto::DownloadChunk chunk;
    chunk.set_size(bytes_.size());
    chunk.set_data(bytes_.substr(from, to > from ? to - from : 0));
    writer.Write(chunk);
  }

  const std::string bytes_;
  std::mutex mutex_;
  std::deque<Step> script_;  // guarded by mutex_
  int calls_ = 0;            // guarded by mutex_
  std::unique_ptr<grpc::Server> server_;
};

using Step = ScriptedBlobs::Step;

class BlobFetcherTest : public testing::Test {
 protected:
  Result<std::string> Get(std::deque<Step> script, FetchPatience patience = kImpatient) {
    const Address address = *ParseAddress("unix:" + (folder_ / "socket"), "test");
    ScriptedBlobs server(address, bytes_, std::move(script));
    const auto cache = BlobStore::Open(folder_ / "cache", BlobStoreOptions::Cache(1 << 20));
    BlobFetcher fetcher(
        OpenChannel(address), *cache, {}, 1, [](uint64_t) {}, patience);
    auto bytes = fetcher.Get(Sha256("package"), Sha256(bytes_), 1 << 20);
    calls_ = server.calls();
    return bytes;
  }
  const TemporaryDir folder_;
  const std::string bytes_ = std::string(1000, 'a') + std::string(1000, 'b');
  int calls_ = 0;
};

TEST_F(BlobFetcherTest, RefusalsStallsAndBrokenTransfersAreTriedAgain) {
  const auto bytes =
      Get({Step::kRefuse, Step::kStall, Step::kAway, Step::kHalf, Step::kRefuse, Step::kServe});
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_EQ(*bytes, bytes_);
  EXPECT_EQ(calls_, 6);
}

TEST_F(BlobFetcherTest, AStreamOfChunksWithoutDataIsAnErrorAtOnce) {
  const auto bytes = Get({Step::kEmpty}, {20s, 20s});
  ASSERT_FALSE(bytes);
  EXPECT_THAT(bytes.error().message, HasSubstr("a chunk without data"));
  EXPECT_EQ(calls_, 1);
}

TEST_F(BlobFetcherTest, ADownloadWithoutProgressFailsInTheEnd) {
  const auto bytes = Get({Step::kRefuse}, {300ms, 500ms});
  ASSERT_FALSE(bytes);
  EXPECT_THAT(bytes.error().message, HasSubstr("too many transfers"));
  EXPECT_GT(calls_, 2);
}

TEST_F(BlobFetcherTest, AFileThatTheCoordinatorLacksIsNotTriedAgain) {
  const auto bytes = Get({Step::kMissing});
  ASSERT_FALSE(bytes);
  EXPECT_EQ(calls_, 1);
}

TEST_F(BlobFetcherTest, ADamagedCachedFileIsFetchedAgain) {
  ASSERT_TRUE(Get({Step::kServe}));
  const auto cache = BlobStore::Open(folder_ / "cache", BlobStoreOptions::Cache(1 << 20));
  const int file = ::open(cache->Path(Sha256(bytes_)).c_str(), O_WRONLY | O_CLOEXEC);
  ASSERT_EQ(::pwrite(file, "x", 1, 5), 1);
  ::close(file);
  const auto bytes = Get({Step::kServe});
  ASSERT_TRUE(bytes);
  EXPECT_EQ(*bytes, bytes_);
  EXPECT_EQ(calls_, 1);
}

}  // namespace
}  // namespace tessera
