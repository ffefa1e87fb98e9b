// Members of a real farm at its web pages.
#include <gmock/gmock.h>

#include <chrono>
#include <thread>

#include "proto/access.grpc.pb.h"
#include "proto/identity/authority.h"
#include "proto/identity/join_token.h"
#include "proto/identity/private_file.h"
#include "proto/identity/subject.h"
#include "proto/wire/convert_access.h"
#include "tests/coordinator/no_file_grows.h"
#include "tests/coordinator/services_fixture.h"
#include "tests/coordinator/web/tls_client.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class WebPagesOfAFarm : public testing::Test {
 protected:
  WebPagesOfAFarm() { Start(); }

  // Starts the coordinator, or restarts it with the same data.
  void Start() {
    coordinator_.reset();
    CoordinatorOptions options;
    options.listen = {*ParseAddress("unix:" + (folder_ / "socket"), "test")};
    options.https = *ParseAddress("127.0.0.1:0", "test");
    options.data_dir = folder_ / "data";
    coordinator_ = std::move(*Coordinator::Start(options));
    access_ = proto::Access::NewStub(OpenChannel(coordinator_->addresses().front()));
  }
  WebClient Browser() const { return WebClient(coordinator_->https()->port); }
  template <typename Method, typename Request, typename Answer>
  void Call(Method method, const Request& request, Answer& answer) {
    grpc::ClientContext context;
    SetDeadline(context, kPatience);
    const grpc::Status status = (access_.get()->*method)(&context, request, &answer);
    EXPECT_TRUE(status.ok()) << status.error_message();
  }
  std::string Token(Role role, const std::string& name = "ada") {
    const JoinToken token = JoinToken::Make("farm:1", {});
    proto::TokenRequest request;
    request.set_key(WriteDigest(token.Key().PublicDigest()));
    request.set_role(WriteRole(role));
    request.set_name(name);
    request.set_lifetime_s(60);
    request.set_uses(1);
    proto::TokenAnswer answer;
    Call(&proto::Access::Stub::IssueToken, request, answer);
    return token.Text();
  }
  proto::AccessAnswer Members() {
    proto::AccessAnswer answer;
    Call(&proto::Access::Stub::ListAccess, proto::AccessRequest(), answer);
    return answer;
  }
  void Revoke(const std::string& which) {
    proto::RevokeRequest request;
    request.set_which(which);
    proto::AccessAnswer answer;
    Call(&proto::Access::Stub::Revoke, request, answer);
  }
  // Key and certificate with this URI, from the authority of the farm.
  std::string Identity(const std::string& uri) const {
    const auto authority =
        Authority::FromPem(*ReadPrivateFile(folder_ / "data/identity/authority.pem"), "authority");
    CertificateTerms terms;
    terms.common_name = "ada";
    terms.uri = uri;
    terms.lifetime = std::chrono::hours(1);
    terms.serial = 7;
    const PrivateKey key = PrivateKey::Generate();
    return key.Pem() + authority->Issue(key, terms, UnixNow()).Pem();
  }

  TemporaryDir folder_;
  std::unique_ptr<Coordinator> coordinator_;
  std::unique_ptr<proto::Access::Stub> access_;
};

TEST_F(WebPagesOfAFarm, EveryRoleThatMayLookAtTheFarmLogsIn) {
  for (const Role role : {Role::kViewer, Role::kUser, Role::kOperator}) {
    WebClient browser = Browser();
    EXPECT_EQ(browser.LogIn(Token(role)).status(), 303);
    EXPECT_EQ(browser.Get("/").status(), 200);
    EXPECT_THAT(browser.Get("/api/v1/me").Body(),
                AllOf(HasSubstr("\"name\":\"ada\""), HasSubstr("\"role\":\"" + std::string(RoleName(role)))));
    EXPECT_EQ(browser.Get("/metrics").status(), 200);
  }
  EXPECT_EQ(Members().members_size(), 3);
}

TEST_F(WebPagesOfAFarm, TheTokenOfAWorkerIsRefusedAndNotUsedUp) {
  const std::string token = Token(Role::kWorker);
  WebClient browser = Browser();
  const WebAnswer refused = browser.LogIn(token);
  EXPECT_EQ(refused.status(), 403);
  EXPECT_THAT(refused.Body(), HasSubstr("may not call the web pages, which needs the role"));
  EXPECT_EQ(Members().tokens(0).uses_left(), 1u);
}

TEST_F(WebPagesOfAFarm, ATokenCountsOnceWhicheverWayItIsUsedAndOverARestart) {
  const std::string token = Token(Role::kViewer);
  WebClient browser = Browser();
  EXPECT_EQ(browser.LogIn(token).status(), 303);
  EXPECT_THAT(Browser().LogIn(token).Body(), HasSubstr("the token has been used up"));
  Start();
  EXPECT_THAT(Browser().LogIn(token).Body(), HasSubstr("the token has been used up"));
}

TEST_F(WebPagesOfAFarm, ARestartEndsSessions) {
  WebClient browser = Browser();
  browser.LogIn(Token(Role::kUser));
  EXPECT_EQ(browser.Get("/metrics").status(), 200);
  Start();
  WebClient again = Browser();
  again.cookie = browser.cookie;
  EXPECT_EQ(again.Get("/metrics").status(), 401);
}

TEST_F(WebPagesOfAFarm, RevokedAndExpiredTokensAreRefusedWithTheReason) {
  const std::string token = Token(Role::kUser, "eve");
  Revoke("eve");
  WebClient browser = Browser();
  EXPECT_THAT(browser.LogIn(token).Body(), HasSubstr("the token was revoked"));
  EXPECT_THAT(browser.LogIn(JoinToken::Make("farm:1", {}).Text()).Body(),
              HasSubstr("this farm does not know the token"));
}

TEST_F(WebPagesOfAFarm, WhoeverIsRevokedIsLoggedOut) {
  WebClient browser = Browser();
  browser.LogIn(Token(Role::kUser, "ada"));
  EXPECT_EQ(browser.Get("/metrics").status(), 200);
  Revoke("ada");
  EXPECT_EQ(browser.Get("/metrics").status(), 401);
}

TEST_F(WebPagesOfAFarm, WhoeverLogsOutIsNoMemberAnyMore) {
  WebClient browser = Browser();
  browser.LogIn(Token(Role::kUser, "ada"));
  EXPECT_EQ(browser.Post("/logout", "proof=" + browser.Get("/api/v1/me").Member("logout_proof")).status(),
            303);
  EXPECT_TRUE(Members().members(0).revoked());
}

TEST_F(WebPagesOfAFarm, ALoginThatCannotBeStoredOpensNoSessionAndNamesTheReason) {
  const std::string first = Token(Role::kViewer), second = Token(Role::kViewer);
  WebClient browser = Browser();
  {
    const NoFileGrows full;
    for (const std::string& token : {first, second}) {
      const WebAnswer refused = browser.LogIn(token);
      EXPECT_EQ(refused.status(), 403);
      EXPECT_THAT(refused.Body(), HasSubstr("Login failed"));
      EXPECT_EQ(browser.Get("/metrics").status(), 401);
    }
  }
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (browser.LogIn(second).status() != 303 && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(milliseconds(1000));
  EXPECT_EQ(browser.Get("/metrics").status(), 200) << "the reason was known, so the second was not used";
}

// Such as Prometheus.
TEST_F(WebPagesOfAFarm, CertificatesOfMembersAreAcceptedUntilTheyAreRevoked) {
  WebClient browser = Browser();
  browser.LogIn(Token(Role::kViewer, "ada"));
  const MemberId id{Members().members(0).member()};
  const WebClient program(coordinator_->https()->port, Identity(Subject{Role::kViewer, id, {}}.Uri()));
  EXPECT_EQ(program.Get("/metrics").status(), 200);
  // The farm knows the role better than the certificate does.
  const WebClient liar(coordinator_->https()->port, Identity(Subject{Role::kOperator, id, {}}.Uri()));
  EXPECT_THAT(liar.Get("/api/v1/me").Body(), HasSubstr("\"role\":\"viewer\""));
  const WebClient unknown(coordinator_->https()->port,
                          Identity(Subject{Role::kOperator, MemberId{1}, {}}.Uri()));
  EXPECT_EQ(unknown.Get("/metrics").status(), 403);
  Revoke("ada");
  EXPECT_EQ(program.Get("/metrics").status(), 403);
  EXPECT_THAT(program.Get("/metrics").Body(), HasSubstr("was revoked"));
}

TEST_F(WebPagesOfAFarm, TheHolderOfATokenSeesNothingWithItsCertificate) {
  const JoinToken token = *JoinToken::Parse(Token(Role::kOperator));
  const WebClient holder(coordinator_->https()->port,
                         token.Key().Pem() + token.MakeCertificate(UnixNow()).Pem());
  EXPECT_EQ(holder.Get("/metrics").status(), 403);
  EXPECT_THAT(holder.Get("/metrics").Body(), HasSubstr("the holder of a token may not call the web pages"));
}

}  // namespace
}  // namespace tessera
