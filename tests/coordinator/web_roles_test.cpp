// Every route of the web interface x every role x owner or not, over real connections.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <iterator>

#include "coordinator/access.h"
#include "coordinator/call_gate.h"
#include "coordinator/web/api/routes.h"
#include "tests/coordinator/members_fixture.h"
#include "tests/coordinator/web/tls_client.h"

namespace tessera {
namespace {

class WebRoles : public ServicesForMembers {
 protected:
  WebRoles() {
    https = *ParseAddress("127.0.0.1:0", "test");
    Restart();
  }
  static std::string PemOf(const JoinedFarm& member) {
    return member.identity.key.Pem() + member.identity.certificate_pem;
  }
  int port() const { return coordinator->https()->port; }
  std::string ProofOf(const JoinedFarm& member) const {
    const WebAnswer me = WebClient(port(), PemOf(member)).Get("/api/v1/me");
    return me.Member("proof");
  }
  // The status of the answer; streams are not read to their end, as they have none.
  int Try(const JoinedFarm& member, const std::string& proof, const WebRoute& route, uint64_t job) const {
    std::string path(route.path);
    for (const auto& [word, value] : {std::pair<std::string, std::string>("{job}", std::to_string(job)),
                                      {"{worker}", "0000000000000007"},
                                      {"{blob}", Sha256("another file").Hex()}}) {
      if (const size_t at = path.find(word); at != std::string::npos) path.replace(at, word.size(), value);
    }
    std::string body;
    if (route.method == "POST")
      body = route.parameters.empty() ? "{}" : fmt::format("{{\"{}\": 5}}", route.parameters);
    TlsClient client(port(), PemOf(member));
    EXPECT_TRUE(client.Handshake());
    client.Send(
        fmt::format("{} {} HTTP/1.1\r\nHost: localhost\r\nX-Tessera-Proof: {}\r\n"
                    "Content-Type: application/json\r\nContent-Length: {}\r\n\r\n{}",
                    route.method, path, proof, body.size(), body));
    return WebAnswer{client.ReadSome()}.status();
  }
  static Reach ReachOfRoute(Role role, const WebRoute& route) {
    for (const CallRule& rule : kCallRules) {
      if (rule.method == route.call) return ReachOf(role, rule.permission);
    }
    return Reach::kNothing;
  }
};

TEST_F(WebRoles, DecideEveryRouteAsTheyDecideItsCall) {
  const JoinedFarm ada = Join(Role::kUser, "ada"), bob = Join(Role::kUser, "bob");
  CallAs(ada);
  const uint64_t job = Submit();
  struct Somebody {
    Role role;
    JoinedFarm member;
    bool is_owner;
  };
  const Somebody people[] = {{Role::kUser, ada, true},
                             {Role::kUser, bob, false},
                             {Role::kViewer, Join(Role::kViewer, "vic"), false},
                             {Role::kOperator, Join(Role::kOperator, "olga"), false},
                             {Role::kWorker, Join(Role::kWorker, "blade"), false}};
  for (const Somebody& somebody : people) {
    const std::string proof = ProofOf(somebody.member);
    for (const WebRoute& route : kWebRoutes) {
      const Reach reach = ReachOfRoute(somebody.role, route);
      const bool is_allowed = reach == Reach::kEverything || (reach == Reach::kOwn && somebody.is_owner);
      const int status = Try(somebody.member, proof, route, job);
      EXPECT_EQ(status != 403, is_allowed) << RoleName(somebody.role) << " " << route.path << " " << status;
      EXPECT_NE(status, 0) << route.path;
    }
  }
}

TEST_F(WebRoles, ASessionMaySeeWhatItsRoleMayAndIsToldWhy) {
  const JoinedFarm viewer = Join(Role::kViewer, "vic");
  const WebClient client(port(), PemOf(viewer));
  const std::string proof = ProofOf(viewer);
  EXPECT_NE(proof, "");
  const uint64_t job = Submit();
  const WebAnswer refused = client.Change(fmt::format("/api/v1/jobs/{}/pause", job), proof);
  EXPECT_EQ(refused.status(), 403);
  EXPECT_THAT(refused.Body(), testing::HasSubstr("needs the role user or operator"));
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_WAITING);
}

TEST_F(WebRoles, TheFilesOfAJobAreLookedAtForItsOwnerOnly) {
  const JoinedFarm ada = Join(Role::kUser, "ada"), bob = Join(Role::kUser, "bob");
  CallAs(ada);
  const uint64_t job = Submit();
  coordinator->blobs().Remove(Sha256("a scene"));
  const auto extend =
      std::ranges::find_if(kWebRoutes, [](const WebRoute& route) { return route.call == "Jobs.Extend"; });
  ASSERT_NE(extend, std::end(kWebRoutes));
  EXPECT_EQ(Try(bob, ProofOf(bob), *extend, job), 403);
  EXPECT_EQ(Try(ada, ProofOf(ada), *extend, job), 409);
}

TEST_F(WebRoles, AChangeIsEnteredInTheAuditLog) {
  const JoinedFarm olga = Join(Role::kOperator, "olga");
  const uint64_t job = Submit();
  testing::internal::CaptureStdout();
  EXPECT_EQ(WebClient(port(), PemOf(olga))
                .Change(fmt::format("/api/v1/jobs/{}/pause", job), ProofOf(olga))
                .status(),
            200);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              testing::ContainsRegex("audit call=Jobs.Pause by=\"operator .*olga.*job=1 result=done"));
}

TEST_F(WebRoles, AChangeThatIsRefusedIsEnteredInTheAuditLogToo) {
  const JoinedFarm olga = Join(Role::kOperator, "olga");
  const WebClient client(port(), PemOf(olga));
  const std::string proof = ProofOf(olga);
  const uint64_t job = Submit();
  coordinator->blobs().Remove(Sha256("a scene"));
  const auto change = [&](const std::string& what, const std::string& body) {
    testing::internal::CaptureStdout();
    client.Change("/api/v1/" + what, proof, body);
    return testing::internal::GetCapturedStdout();
  };
  EXPECT_THAT(
      change("jobs/99/pause", "{}"),
      testing::ContainsRegex("audit call=Jobs.Pause .*job=99 result=failed reason=\"there is no job"));
  EXPECT_THAT(change(fmt::format("jobs/{}/priority", job), R"({"priority": 1000001})"),
              testing::ContainsRegex("audit call=Jobs.SetPriority .*job=1 priority=1000001 result=failed"));
  EXPECT_THAT(change(fmt::format("jobs/{}/extend", job), R"({"samples_per_pixel": 8})"),
              testing::ContainsRegex("audit call=Jobs.Extend .*samples_per_pixel=8 result=failed .*not upl"));
  EXPECT_THAT(change("workers/00000000000000ff/drain", "{}"),
              testing::ContainsRegex("audit call=Jobs.DrainWorkers .*worker=.*ff.* result=failed"));
}

TEST_F(WebRoles, AValueOutOfRangeIsRefusedAsTheCallsRefuseIt) {
  const JoinedFarm olga = Join(Role::kOperator, "olga");
  CallAs(olga);
  proto::PriorityRequest priority;
  priority.set_job(Submit());
  priority.set_priority(-1'000'001);
  proto::JobStatus status;
  const grpc::Status refused = Call(*jobs, &proto::Jobs::Stub::SetPriority, priority, status);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(refused.error_message(), "priority: expected -1000000 to 1000000");
  const WebAnswer answer = WebClient(port(), PemOf(olga))
                               .Change(fmt::format("/api/v1/jobs/{}/priority", priority.job()), ProofOf(olga),
                                       R"({"priority": -1000001})");
  EXPECT_EQ(answer.status(), 400);
  EXPECT_EQ(answer.Member("error"), refused.error_message());
}

TEST_F(WebRoles, FailuresAreEnteredOneByOneUpToTheLimitOfOtherCalls) {
  const JoinedFarm olga = Join(Role::kOperator, "olga");
  const WebClient client(port(), PemOf(olga));
  const std::string proof = ProofOf(olga);
  const auto begun = std::chrono::steady_clock::now();
  testing::internal::CaptureStdout();
  for (int i = 0; i < 150; ++i) EXPECT_EQ(client.Change("/api/v1/jobs/99/pause", proof).status(), 404);
  const std::string log = testing::internal::GetCapturedStdout();
  const auto intervals = (std::chrono::steady_clock::now() - begun) / CallGate::kLogInterval + 2;
  int entries = 0;
  for (size_t at = log.find("audit call=Jobs.Pause"); at != std::string::npos;
       at = log.find("audit call=Jobs.Pause", at + 1))
    ++entries;
  EXPECT_GE(entries, CallGate::kFailuresLogged);
  EXPECT_LE(entries, std::min<int64_t>(149, CallGate::kFailuresLogged * intervals));
}

}  // namespace
}  // namespace tessera
