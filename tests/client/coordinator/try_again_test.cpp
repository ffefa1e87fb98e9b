// A coordinator that asks to try again is asked again by every call that the client makes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <map>
#include <mutex>

#include "client/coordinator/coordinator_client.h"
#include "proto/jobs.pb.h"
#include "proto/shell/system.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "tests/coordinator/generic_call.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/sanitizers.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr milliseconds kLong{kSlowdown * 60'000};

grpc::ByteBuffer Encoded(const google::protobuf::Message& message) {
  const grpc::Slice bytes(message.SerializeAsString());
  return grpc::ByteBuffer(&bytes, 1);
}

// Answers the question for its version, and refuses each other method a number of times with TryAgain and
// then for good.
class BusyCoordinator final : public grpc::CallbackGenericService {
 public:
  BusyCoordinator(const Address& address, int refusals, std::string version = kSoftwareVersion,
                  uint32_t protocol = kProtocolVersion)
      : refusals_(refusals), version_(std::move(version)), protocol_(protocol) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address.Target(), grpc::InsecureServerCredentials());
    builder.RegisterCallbackGenericService(this);
    server_ = builder.BuildAndStart();
  }
  ~BusyCoordinator() override {
    server_->Shutdown(std::chrono::system_clock::now() + std::chrono::seconds(1));
  }
  // By method ("/tessera.Jobs/Status").
  std::map<std::string, int> calls() const {
    const std::lock_guard lock(mutex_);
    return calls_;
  }

 private:
  class Reactor final : public grpc::ServerGenericBidiReactor {
   public:
    explicit Reactor(grpc::Status refusal) { Finish(std::move(refusal)); }
    explicit Reactor(const google::protobuf::Message& answer) : answer_(Encoded(answer)) {
      StartWriteAndFinish(&answer_, {}, grpc::Status::OK);
    }
    void OnDone() override { delete this; }

   private:
    grpc::ByteBuffer answer_;
  };
  grpc::ServerGenericBidiReactor* CreateReactor(grpc::GenericCallbackServerContext* context) override {
    if (context->method().ends_with("/Health")) {
      proto::HealthAnswer health;
      health.set_software_version(version_);
      health.set_protocol(protocol_);
      health.set_farm(WriteFarmId(RandomFarmId()));
      return new Reactor(health);
    }
    const std::lock_guard lock(mutex_);
    const bool is_busy = calls_[context->method()]++ < refusals_;
    return new Reactor(is_busy ? TryAgain("too many things are waiting")
                               : grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, "refused for good"));
  }

  const int refusals_;
  const std::string version_;
  const uint32_t protocol_;
  mutable std::mutex mutex_;
  std::map<std::string, int> calls_;  // guarded by mutex_
  std::unique_ptr<grpc::Server> server_;
};

template <typename T>
Error ErrorOf(const Result<T>& result) {
  EXPECT_FALSE(result);
  return result ? Failed("none") : result.error();
}

class BusyFarm : public testing::Test {
 protected:
  std::unique_ptr<CoordinatorClient> Connect(milliseconds patience) {
    auto client = CoordinatorClient::Connect(address_, {kLong, patience}, {});
    EXPECT_TRUE(client) << client.error().message;
    return std::move(*client);
  }
  const TemporaryDir folder_;
  const Address address_ = *ParseAddress("unix:" + (folder_ / "socket"), "test");
};

TEST_F(BusyFarm, EveryCallIsRepeatedWhileTheCoordinatorAsksToTryAgain) {
  constexpr int kRefusals = 3;
  BusyCoordinator coordinator(address_, kRefusals);
  const auto client = Connect(kLong);
  const JobId job{1};
  uint64_t left_out = 0;
  const std::vector<Error> errors{
      ErrorOf(client->Status(job)),
      ErrorOf(client->Frames(job)),
      ErrorOf(client->JobLog(job, 0)),
      ErrorOf(client->FetchPicture(job, 0, false, folder_.path())),
      ErrorOf(client->Watch(job, [](const JobStatus&) {})),
      ErrorOf(client->Cancel(job)),
      ErrorOf(client->Extend(job, 8)),
      ErrorOf(client->Pause(job)),
      ErrorOf(client->Resume(job)),
      ErrorOf(client->SetPriority(job, 3)),
      ErrorOf(client->Jobs(left_out)),
      ErrorOf(client->Workers(left_out)),
      ErrorOf(client->Drain("any", left_out)),
      ErrorOf(client->Release("any", left_out)),
      ErrorOf(client->Upload({})),
      ErrorOf(client->Submit({}, {})),
      ErrorOf(client->ListAccess()),
      ErrorOf(client->Revoke("any")),
  };
  for (const Error& error : errors) EXPECT_THAT(error.message, HasSubstr("refused for good"));
  const std::map<std::string, int> calls = coordinator.calls();
  // Not made by this client, or only while a connection is made; uploads are tested below.
  const std::set<std::string> others{"Jobs.Health",           "Access.Join",        "Access.Renew",
                                     "Access.IssueToken",     "Blobs.Download",     "Blobs.Upload",
                                     "Work.Synchronize",      "Work.ReturnResults", "Work.ReturnFailure",
                                     "Work.ReturnPreparation"};
  for (const auto* method : AllMethods()) {
    if (others.contains(NameOf(*method))) continue;
    const auto made = calls.find("/" + method->service()->full_name() + "/" + method->name());
    ASSERT_NE(made, calls.end()) << NameOf(*method);
    EXPECT_GT(made->second, kRefusals) << NameOf(*method);
  }
}

TEST_F(BusyFarm, TheReasonIsReportedOncePatienceIsOver) {
  BusyCoordinator coordinator(address_, 1'000'000);
  const auto client = Connect(milliseconds(1500));
  const auto start = std::chrono::steady_clock::now();
  const Error error = ErrorOf(client->FetchPicture(JobId{1}, 0, false, folder_.path()));
  EXPECT_LT(std::chrono::steady_clock::now() - start, kLong);
  EXPECT_EQ(error.kind, ErrorKind::kFailed);
  EXPECT_THAT(error.message, HasSubstr("too many things are waiting"));
  const int calls = coordinator.calls().at("/tessera.proto.Jobs/FetchPicture");
  EXPECT_GT(calls, 1);
  EXPECT_LT(calls, 12) << "the pauses grow";
}

TEST_F(BusyFarm, ACoordinatorOfAnotherReleaseIsNotUsedAndBothReleasesAreNamed) {
  const std::pair<std::string, uint32_t> others[] = {{"0.1.0", kProtocolVersion},
                                                     {kSoftwareVersion, kProtocolVersion - 1},
                                                     {kSoftwareVersion, kProtocolVersion + 1}};
  for (const auto& [version, protocol] : others) {
    BusyCoordinator coordinator(address_, 0, version, protocol);
    const Error error = ErrorOf(CoordinatorClient::Connect(address_, {kLong, kLong}, {}));
    EXPECT_EQ(error.kind, ErrorKind::kFailed);
    EXPECT_THAT(error.message,
                HasSubstr(fmt::format("the coordinator has version {} (protocol {}) and this program version "
                                      "{} (protocol {}); install the same release on both",
                                      version, protocol, kSoftwareVersion, kProtocolVersion)));
    EXPECT_TRUE(coordinator.calls().empty()) << "nothing is sent to it";
  }
}

TEST_F(BusyFarm, WithoutPatienceACallIsMadeOnce) {
  BusyCoordinator coordinator(address_, 1'000'000);
  ErrorOf(Connect(milliseconds(0))->Status(JobId{1}));
  EXPECT_EQ(coordinator.calls().at("/tessera.proto.Jobs/Status"), 1);
}

}  // namespace
}  // namespace tessera
