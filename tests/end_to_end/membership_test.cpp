// Members join over TLS with tokens; everybody else stays out.
#include <gmock/gmock.h>

#include <signal.h>
#include <fstream>

#include <filesystem>
#include <memory>

#include "tests/end_to_end/membership_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST_F(MembershipOfAFarm, AJobIsRenderedByAWorkerThatJoinedForAUserWhoLoggedIn) {
  const std::string oracle = Oracle(BoxScene(), {"--spp", "8"});
  Process& worker = JoinWorker("blade", Token({"--role", "worker"}));
  ASSERT_TRUE(worker.AwaitErrors("connected worker=")) << worker.Errors();
  LogIn("ada", "user");
  const Outcome outcome = As("ada", "submit " + BoxScene() + " --spp 8 --watch");
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_EQ(As("ada", "fetch 1 -o farm.exr").code, 0);
  EXPECT_EQ(Bytes("farm.exr"), oracle);
  EXPECT_THAT(coordinator().Errors(), HasSubstr("audit call=Access.Join by=\"the holder of a token\""));
}

TEST_F(MembershipOfAFarm, TokensAreNotInTheListOfProcessesAndMayComeOnStandardInput) {
  const std::string token = Token({"--role", "worker"});
  Process& worker = JoinWorker("blade", token);
  ASSERT_TRUE(worker.AwaitErrors("joined ")) << worker.Errors();
  std::ifstream file("/proc/" + std::to_string(worker.pid()) + "/cmdline");
  const std::string words{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(words, HasSubstr("--join"));
  EXPECT_THAT(words, testing::Not(HasSubstr(token)));
  const Outcome outcome = As("ada", "login - <<< " + Token({"--role", "user", "--name", "ada"}));
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_EQ(As("ada", "jobs").code, 0);
  EXPECT_THAT(As("bob", "login - < /dev/null").errors, HasSubstr("there is no token on standard input"));
}

TEST_F(MembershipOfAFarm, AWorkerRestartsWithTheSameTokenAndWithoutOne) {
  const std::string token = Token({"--role", "worker"});
  Process& first = JoinWorker("blade", token);
  ASSERT_TRUE(first.AwaitErrors("connected worker=")) << first.Errors();
  first.Signal(SIGTERM);
  EXPECT_EQ(first.Wait(), 0);
  EXPECT_TRUE(JoinWorker("blade", token).AwaitErrors("connected worker="));
  EXPECT_TRUE(
      StartUnaddressedWorker("again", {"--state-dir", Path("state-blade")}).AwaitErrors("connected worker="));
}

TEST_F(MembershipOfAFarm, ATokenThatWasUsedExpiredOrRevokedIsRefusedWithTheReason) {
  const std::string used = Token({"--role", "viewer"});
  EXPECT_EQ(As("ada", "login " + used).code, 0);
  const auto expect_refused = [&](const std::string& token, const std::string& reason) {
    const Outcome refused = As("eve", "login " + token);
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.errors, HasSubstr(reason));
  };
  expect_refused(used, "the token has been used up; ask an operator of the farm for another");
  const std::string short_lived = Token({"--role", "viewer", "--ttl", "1s", "--uses", "1000"});
  EXPECT_TRUE(Eventually([&] { return As("eve", "login " + short_lived).code == 1; }));
  expect_refused(short_lived, "the token has expired");
  const std::string revoked = Token({"--role", "viewer", "--name", "eve"});
  EXPECT_EQ(Ask({"access", "--revoke", "eve"}).code, 0);
  expect_refused(revoked, "the token was revoked");
}

TEST_F(MembershipOfAFarm, ATokenOfAnotherFarmIsRefusedBeforeAnythingIsSent) {
  const std::string token = Token({"--role", "worker"});
  coordinator().Signal(SIGTERM);
  EXPECT_EQ(coordinator().Wait(), 0);
  RunShell(folder(), "mv data other");
  StartCoordinator();
  const Outcome refused = As("ada", "login " + token);
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.errors, HasSubstr("is not the one that made the token"));
}

TEST_F(MembershipOfAFarm, RolesLimitWhatMembersMayDo) {
  LogIn("vera", "viewer");
  LogIn("wanda", "worker");
  EXPECT_EQ(As("vera", "jobs").code, 0);
  const Outcome submit = As("vera", "submit " + BoxScene());
  EXPECT_EQ(submit.code, 1);
  EXPECT_THAT(submit.errors, HasSubstr("viewer \"vera\" may not call Blobs.FindMissing"));
  EXPECT_THAT(submit.errors, HasSubstr("needs the role user or operator"));
  EXPECT_THAT(As("wanda", "jobs").errors, HasSubstr("may not call Jobs.List"));
  EXPECT_THAT(As("vera", "access").errors, HasSubstr("needs the role operator"));
  EXPECT_THAT(coordinator().Errors(), HasSubstr("call_denied"));
}

TEST_F(MembershipOfAFarm, WhoeverLogsOutHasNoKeyAnyMore) {
  for (const char* farm : {"home", "studio"}) {
    const Outcome login = As("ada", "login " + Token({"--role", "user"}) + " --farm " + farm);
    ASSERT_EQ(login.code, 0) << login.errors;
  }
  ASSERT_EQ(As("ada", "jobs").code, 0);
  const Outcome logout = As("ada", "logout");
  EXPECT_EQ(logout.code, 0);
  EXPECT_THAT(logout.errors, HasSubstr("logged out of " + address()));
  EXPECT_THAT(logout.errors, HasSubstr("give other commands --farm (home)"));
  const Outcome jobs = As("ada", "jobs --farm studio");
  EXPECT_EQ(jobs.code, 2);
  EXPECT_THAT(jobs.errors, HasSubstr("there is no login of this name (there are: home)"));
  EXPECT_EQ(As("ada", "jobs --farm home").code, 0);
  const Outcome again = As("ada", "logout");
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.errors, HasSubstr("there is no last login; name the farm (there are: home)"));
  EXPECT_EQ(As("ada", "logout ../../ada").code, 2);
  EXPECT_EQ(As("ada", "logout home").code, 0);
  EXPECT_FALSE(std::filesystem::exists(Path("ada/tessera/farms/home")));
}

TEST_F(MembershipOfAFarm, UsersTouchOnlyTheirOwnJobsAndSeeWhoseTheOthersAre) {
  LogIn("ada", "user");
  LogIn("bob", "user");
  const Outcome submitted = As("ada", "submit " + BoxScene() + " --spp 8");
  ASSERT_EQ(submitted.code, 0) << submitted.errors;
  for (const char* command : {"cancel 1", "pause 1", "priority 1 5", "fetch 1 --preview"}) {
    const Outcome denied = As("bob", command);
    EXPECT_EQ(denied.code, 1) << command;
    EXPECT_THAT(denied.errors, HasSubstr("which belongs to \"ada\"; ask its owner or an operator"));
  }
  EXPECT_THAT(As("bob", "jobs").output, HasSubstr("  ada  "));
  EXPECT_THAT(As("bob", "status 1").output, HasSubstr(", owner ada: waiting"));
  EXPECT_THAT(As("bob", "jobs --json").output, HasSubstr("\"owner\":\"ada\",\"owner_member\":\""));
  EXPECT_EQ(As("ada", "cancel 1").code, 0);
}

TEST_F(MembershipOfAFarm, SocketsOfKilledCoordinatorsAreRemovedByTheNext) {
  std::filesystem::create_directory(Path("user"));
  const auto start = [&](const std::string& data_dir) {
    return std::make_unique<Process>(
        folder(), "/usr/bin/env",
        std::vector<std::string>{"XDG_RUNTIME_DIR=" + Path("user"), BinaryDir() + "/bin/tessera-coordinator",
                                 "--listen", "127.0.0.1:0", "--data-dir", Path(data_dir)});
  };
  const auto sockets = [&] {
    const std::filesystem::directory_iterator entries(Path("user/tessera"));
    return std::distance(begin(entries), end(entries));
  };
  const auto killed = start("first");
  ASSERT_TRUE(killed->AwaitErrors("listening on")) << killed->Errors();
  killed->Signal(SIGKILL);
  killed->Wait();
  EXPECT_EQ(sockets(), 1);
  const auto next = start("second");
  ASSERT_TRUE(next->AwaitErrors("listening on")) << next->Errors();
  EXPECT_THAT(next->Errors(), HasSubstr("stale_sockets_removed count=1"));
  EXPECT_EQ(sockets(), 1);
  next->Signal(SIGTERM);
  EXPECT_EQ(next->Wait(), 0);
  EXPECT_EQ(sockets(), 0);
}

TEST_F(MembershipOfAFarm, WhoeverIsRevokedIsOutFromTheNextCallOnAndAfterARestart) {
  LogIn("ada", "user");
  EXPECT_EQ(As("ada", "jobs").code, 0);
  const Outcome revoked = Ask({"access", "--revoke", "ada"});
  EXPECT_EQ(revoked.code, 0) << revoked.errors;
  EXPECT_THAT(revoked.output, HasSubstr("revoked"));
  for (int round = 0; round < 2; ++round) {
    const Outcome outcome = As("ada", "jobs");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.errors, HasSubstr("the certificate of user \"ada\" was revoked"));
    StartCoordinator();
  }
}

TEST_F(MembershipOfAFarm, AnOpenWatchEndsWhenItsMemberIsRevoked) {
  LogIn("ada", "user");
  StartWorker("only");
  const std::string job = Submit(BoxScene(), kLongRender);
  Process watch(folder(), "/usr/bin/env",
                {"XDG_CONFIG_HOME=" + Path("ada"), BinaryDir() + "/bin/tessera", "watch", job});
  EXPECT_TRUE(Eventually([&] { return !watch.Errors().empty(); }, std::chrono::seconds(30)));
  EXPECT_EQ(Ask({"access", "--revoke", "ada"}).code, 0);
  EXPECT_EQ(watch.Wait(), 1);
  EXPECT_THAT(watch.Errors(), HasSubstr("was revoked"));
}

TEST_F(MembershipOfAFarm, AWorkerThatIsRevokedEndsWithTheReason) {
  Process& worker = JoinWorker("blade", Token({"--role", "worker", "--name", "blade"}));
  ASSERT_TRUE(worker.AwaitErrors("connected worker=")) << worker.Errors();
  EXPECT_EQ(Ask({"access", "--revoke", "blade"}).code, 0);
  EXPECT_EQ(worker.Wait(), 1);
  EXPECT_THAT(worker.Errors(), HasSubstr("was revoked"));
}

TEST_F(MembershipOfAFarm, ATokenLetsInAsManyAsItWasMadeFor) {
  const std::string token = Token({"--role", "worker", "--uses", "2"});
  EXPECT_TRUE(JoinWorker("a", token).AwaitErrors("connected worker="));
  EXPECT_TRUE(JoinWorker("b", token).AwaitErrors("connected worker="));
  EXPECT_EQ(JoinWorker("c", token).Wait(), 1);
}

TEST_F(MembershipOfAFarm, WithoutALoginTheAddressOfAnotherMachineIsRefusedWithTheRemedy) {
  for (const char* program : {"tessera", "tessera-worker"}) {
    std::vector<std::string> words{"--coordinator", "10.255.255.1:7700"};
    if (program == std::string("tessera")) words.insert(words.begin(), "jobs");
    const Outcome outcome = RunProgram(folder(), program, words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.errors, HasSubstr("ask its operator for a token"));
  }
}

TEST_F(MembershipOfAFarm, AMissingAuthorityIsNamedInsteadOfShuttingMembersOut) {
  LogIn("ada", "user");
  coordinator().Signal(SIGTERM);
  EXPECT_EQ(coordinator().Wait(), 0);
  RunShell(folder(), "mv data/identity identity");
  const Outcome outcome =
      RunProgram(folder(), "tessera-coordinator", {"--listen", address(), "--data-dir", Path("data")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("the key of the farm's authority is missing"));
  RunShell(folder(), "mv identity data/identity");
  StartCoordinator();
  EXPECT_EQ(As("ada", "jobs").code, 0);
}

}  // namespace
}  // namespace tessera
