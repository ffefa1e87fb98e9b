// Members are told from strangers by their first call, over real connections.
#include <gmock/gmock.h>
#include <sys/socket.h>

#include <functional>

#include "coordinator/listener/pending_connections.h"
#include "proto/access.grpc.pb.h"
#include "proto/identity/join_token.h"
#include "proto/identity/login.h"
#include "proto/wire/convert_access.h"
#include "proto/wire/endpoint.h"
#include "proto/wire/membership_calls.h"
#include "tests/coordinator/services_fixture.h"
#include "tests/coordinator/web/tls_client.h"

namespace tessera {
namespace {

// A coordinator with encrypted connections, at both versions of IP.
class EncryptedFarm : public testing::Test {
 protected:
  EncryptedFarm() {
    CoordinatorOptions options;
    options.listen = {*ParseAddress("unix:" + (folder_ / "socket"), "test"),
                      *ParseAddress("127.0.0.1:0", "test"), *ParseAddress("[::1]:0", "test")};
    options.data_dir = folder_ / "data";
    coordinator_ = std::move(*Coordinator::Start(options));
  }
  const Address& address(size_t i) const { return coordinator_->addresses()[i]; }
  int port() const { return address(1).port; }

  // A new member who uses this address.
  Login Join(const Address& address) {
    const auto operator_channel = OpenChannel(coordinator_->addresses().front());
    proto::TokenRequest request;
    proto::TokenAnswer answer;
    JoinToken token = JoinToken::Make(address.Text(), {});
    request.set_key(WriteDigest(token.Key().PublicDigest()));
    request.set_role(WriteRole(Role::kUser));
    request.set_lifetime_s(60);
    request.set_uses(1);
    grpc::ClientContext context;
    EXPECT_TRUE(proto::Access::NewStub(operator_channel)->IssueToken(&context, request, &answer).ok());
    token.authority = *coordinator_->authority_fingerprint();
    const auto joined = JoinFarm(token, "ada");
    EXPECT_TRUE(joined) << (joined ? "" : joined.error().message);
    return *LoginStore(folder_ / "farms").Save("farm", address.Text(), joined->identity);
  }
  static bool List(const std::shared_ptr<grpc::Channel>& channel) {
    grpc::ClientContext context;
    SetDeadline(context, kPatience);
    proto::ListAnswer answer;
    return proto::Jobs::NewStub(channel)->List(&context, proto::ListRequest(), &answer).ok();
  }
  bool PendingBecomes(const std::function<bool(size_t)>& condition) const {
    return ComesTrue([&] { return condition(coordinator_->pending_connections()); });
  }

  TemporaryDir folder_;
  std::unique_ptr<Coordinator> coordinator_;
};

TEST_F(EncryptedFarm, AMemberIsPendingUntilItsFirstCall) {
  for (const size_t i : {1, 2}) {
    const Login login = Join(address(i));
    const auto channel = OpenChannel(*EndpointOf(login));
    EXPECT_TRUE(WaitForConnection(*channel, kPatience));
    EXPECT_TRUE(PendingBecomes([](size_t count) { return count > 0; })) << address(i).Text();
    EXPECT_TRUE(List(channel));
    EXPECT_TRUE(PendingBecomes([](size_t count) { return count == 0; })) << address(i).Text();
    EXPECT_EQ(channel->GetState(false), GRPC_CHANNEL_READY);
  }
}

TEST_F(EncryptedFarm, StrangersStayPendingUntilTheirConnectionsAreClosed) {
  const int silent = ConnectTo(port());
  EXPECT_TRUE(PendingBecomes([](size_t count) { return count == 1; }));
  ::close(silent);
  EXPECT_TRUE(PendingBecomes([](size_t count) { return count == 0; }));
  {
    TlsClient stranger(port());
    stranger.Handshake();
    EXPECT_EQ(stranger.ReadAll(), "") << "the server ends the connection";
  }
  const int garbage = ConnectTo(port());
  const std::string bytes(100'000, 'x');
  ::send(garbage, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  EXPECT_TRUE(PendingBecomes([](size_t count) { return count == 0; }));
  ::close(garbage);
}

TEST_F(EncryptedFarm, MoreMembersThanMayBePendingKeepTheirConnections) {
  const Login login = Join(address(1));
  std::vector<std::shared_ptr<grpc::Channel>> channels;
  for (size_t i = 0; i < kPendingPerNetworkMax + 20; ++i) {
    channels.push_back(OpenChannel(*EndpointOf(login)));
    EXPECT_TRUE(List(channels.back()));
  }
  EXPECT_TRUE(PendingBecomes([](size_t count) { return count == 0; }));
  std::vector<int> crowd;
  for (size_t i = 0; i < kPendingPerNetworkMax + 20; ++i) crowd.push_back(ConnectTo(port()));
  // On a slow machine the server has closed the first ones by now, as they are idle.
  for (size_t i = kPendingPerNetworkMax; i < channels.size(); ++i)
    EXPECT_EQ(channels[i]->GetState(false), GRPC_CHANNEL_READY);
  EXPECT_LE(coordinator_->pending_connections(), kPendingPerNetworkMax);
  for (const int each : crowd) ::close(each);
}

// A handshake that does not end is not paid for by the time of others.
TEST_F(EncryptedFarm, EachPeerEndsAfterTheTimeOfAHandshake) {
  const int silent = ConnectTo(port());
  EXPECT_EQ(ReadPlain(silent), "") << "returns when the server closes the connection";
  EXPECT_TRUE(PendingBecomes([](size_t count) { return count == 0; }));
  ::close(silent);
}

}  // namespace
}  // namespace tessera
