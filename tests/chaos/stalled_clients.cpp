#include "tests/chaos/stalled_clients.h"

#include <fmt/format.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <algorithm>
#include <condition_variable>
#include <memory>
#include <stop_token>

#include "proto/blobs.grpc.pb.h"
#include "proto/jobs.grpc.pb.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "renderer/util/digest.h"

namespace tessera {
namespace {

constexpr int kCallsOfEachKind = 8;
// A coordinator gives up on a peer after 30 s; the machine may be loaded.
constexpr std::chrono::seconds kStallMax{50};
constexpr std::chrono::seconds kConnectPatience{3}, kCheckPatience{10};
constexpr uint64_t kUploadBytes = uint64_t{8} << 20;
constexpr size_t kUploadedBytes = 64 << 10;  // less than is kept of a file that was interrupted

Digest StalledFile(int number) {
  return Sha256(fmt::format("stalled {}", number));
}

// Takes hardly anything before it reads.
std::shared_ptr<grpc::Channel> NarrowChannel(const std::string& address) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, 16);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

// A call that stalls.
class StalledCall {
 public:
  StalledCall() { SetDeadline(context_, kStallMax + kConnectPatience + kCheckPatience); }
  virtual ~StalledCall() { context_.TryCancel(); }
  // Goes on with the call. Returns what is wrong, or an empty text.
  virtual std::string Check() = 0;

 protected:
  grpc::ClientContext context_;
};

class UnreadPicture : public StalledCall {
 public:
  UnreadPicture(proto::Jobs::Stub& stub, uint64_t job) {
    proto::FetchRequest request;
    request.set_job(job);
    reader_ = stub.FetchPicture(&context_, request);
  }
  ~UnreadPicture() override {
    context_.TryCancel();
    if (reader_ != nullptr) Check();
  }
  std::string Check() override {
    proto::PictureChunk chunk;
    while (reader_->Read(&chunk)) {
    }
    const bool is_whole = std::exchange(reader_, nullptr)->Finish().ok();
    return is_whole ? "sent a picture to the end that nobody had taken" : "";
  }

 private:
  std::unique_ptr<grpc::ClientReader<proto::PictureChunk>> reader_;
};

// Progress waits for as long as the client likes: it takes no memory.
class UnreadProgress : public StalledCall {
 public:
  UnreadProgress(proto::Jobs::Stub& stub, uint64_t job) {
    proto::JobRequest request;
    request.set_job(job);
    reader_ = stub.Watch(&context_, request);
  }
  ~UnreadProgress() override {
    context_.TryCancel();
    proto::JobStatus status;
    while (reader_->Read(&status)) {
    }
    reader_->Finish();
  }
  std::string Check() override { return ""; }

 private:
  std::unique_ptr<grpc::ClientReader<proto::JobStatus>> reader_;
};

class BrokenOffUpload : public StalledCall {
 public:
  BrokenOffUpload(proto::Blobs::Stub& stub, int number) : writer_(stub.Upload(&context_, &answer_)) {
    proto::UploadChunk chunk;
    chunk.set_digest(WriteDigest(StalledFile(number)));
    chunk.set_size(kUploadBytes);
    chunk.set_data(std::string(kUploadedBytes, 'x'));
    writer_->Write(chunk);
  }
  ~BrokenOffUpload() override {
    context_.TryCancel();
    if (writer_ != nullptr) Check();
  }
  // A coordinator that still waits for the rest finds that it is missing.
  std::string Check() override {
    writer_->WritesDone();
    const grpc::Status status = std::exchange(writer_, nullptr)->Finish();
    const bool has_waited = status.ok() || status.error_code() == grpc::StatusCode::INVALID_ARGUMENT;
    return has_waited ? "waited for the rest of a file: " + status.error_message() : "";
  }

 private:
  proto::UploadAnswer answer_;
  std::unique_ptr<grpc::ClientWriter<proto::UploadChunk>> writer_;
};

}  // namespace

void StalledClients::Open(Target target) {
  const std::lock_guard lock(mutex_);
  ++open_;
  threads_.emplace_back(
      [this, target = std::move(target)](const std::stop_token& stop) { Stall(stop, target); });
}

void StalledClients::Stall(const std::stop_token& stop, const Target& target) {
  const auto channel = NarrowChannel(target.address);
  const auto jobs = proto::Jobs::NewStub(channel);
  const auto blobs = proto::Blobs::NewStub(channel);
  std::vector<std::unique_ptr<StalledCall>> calls;
  if (WaitForConnection(*channel, kConnectPatience)) {
    for (int i = 0; i < kCallsOfEachKind; ++i) {
      calls.push_back(std::make_unique<UnreadPicture>(*jobs, target.job));
      calls.push_back(std::make_unique<UnreadProgress>(*jobs, target.job));
      calls.push_back(std::make_unique<BrokenOffUpload>(*blobs, i));
    }
  }
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex_);
  const bool is_stopped = stopped.wait_for(lock, stop, calls.empty() ? std::chrono::seconds(0) : kStallMax,
                                           [&] { return stop.stop_requested(); });
  lock.unlock();
  std::vector<std::string> problems;
  for (const auto& call : calls) {
    if (is_stopped) break;
    if (const std::string problem = call->Check(); !problem.empty())
      problems.push_back(fmt::format("a coordinator {} after {} s", problem, kStallMax.count()));
  }
  const int checked = is_stopped ? 0 : static_cast<int>(calls.size());
  calls.clear();
  lock.lock();
  checked_ += checked;
  problems_.insert(problems_.end(), problems.begin(), problems.end());
  --open_;
}

std::string StalledClients::Files() {
  std::string digests;
  for (int i = 0; i < kCallsOfEachKind; ++i) digests += StalledFile(i).Hex() + " ";
  return digests;
}

int StalledClients::open() const {
  const std::lock_guard lock(mutex_);
  return open_;
}
int StalledClients::checked() const {
  const std::lock_guard lock(mutex_);
  return checked_;
}

void StalledClients::End() {
  std::vector<std::jthread> threads;
  {
    const std::lock_guard lock(mutex_);
    threads = std::move(threads_);
    threads_.clear();
  }
  for (std::jthread& thread : threads) thread.request_stop();
}

std::vector<std::string> StalledClients::problems() const {
  const std::lock_guard lock(mutex_);
  return problems_;
}

}  // namespace tessera
