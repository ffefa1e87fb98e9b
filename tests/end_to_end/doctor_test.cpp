// `tessera doctor` on machines with real faults.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "proto/identity/authority.h"
#include "proto/identity/login.h"
#include "proto/identity/subject.h"
#include "tests/end_to_end/farm_fixture.h"
#include "tests/listening_socket.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

class Doctor : public EndToEnd {
 protected:
  // The user of the coordinator has a login too, which is not used here.
  Outcome AsOperator(const std::string& program, const std::string& words) const {
    return RunShell(folder(), fmt::format("XDG_CONFIG_HOME={} {}/bin/{} {} --coordinator {}", Path("none"),
                                          BinaryDir(), program, words, address()));
  }
  std::string Token(const std::string& role) const {
    const Outcome made = AsOperator("tessera-coordinator", "token --role " + role);
    EXPECT_EQ(made.code, 0) << made.errors;
    return made.output.substr(0, made.output.find('\n'));
  }
  void LogIn(const std::string& role = "user") const {
    const Outcome done = Tessera({"login", Token(role), "--farm", "studio"});
    EXPECT_EQ(done.code, 0) << done.errors;
  }
  std::string LoginFolder() const { return Path("config/tessera/farms/studio"); }

  // Runs it with these words of a shell before it. Other tests run coordinators at the same time, so only
  // what was found in places whose name contains one of `places` is returned, as lines "SEVERITY WHAT ->
  // REMEDY".
  std::string Examine(const std::vector<std::string>& places, const std::string& words = "",
                      const std::string& before = "") {
    const Outcome outcome = RunShell(folder(), before + " $tessera doctor --json " + words);
    const auto json = nlohmann::json::parse(outcome.output, nullptr, false);
    if (json.is_discarded()) return "no JSON: " + outcome.output + outcome.errors;
    EXPECT_EQ(outcome.code, json["problems"] > 0 ? 1 : 0);
    std::string text;
    for (const auto& each : json["findings"]) {
      const auto where = each["where"].get<std::string>();
      if (std::ranges::none_of(places,
                               [&](const auto& place) { return where.find(place) != std::string::npos; }))
        continue;
      text += fmt::format("{} {} -> {}\n", each["severity"].get<std::string>(),
                          each["what"].get<std::string>(), each["remedy"].get<std::string>());
    }
    return text;
  }
  std::string ExamineLogin() { return Examine({"login \"studio\""}); }
  std::string ThisCoordinator() { return fmt::format("coordinator (process {})", coordinator().pid()); }
};

TEST_F(Doctor, FindsNothingWrongWithAHealthyFarm) {
  StartCoordinator();
  LogIn();
  Process& worker = StartUnaddressedWorker("blade", {"--join", Token("worker")});
  ASSERT_TRUE(worker.AwaitErrors("connected worker="));
  const std::string found =
      Examine({"login \"studio\"", "worker of", ThisCoordinator(), "data directory " + Path("data")});
  EXPECT_THAT(found, Not(HasSubstr("problem ")));
  EXPECT_THAT(found, HasSubstr("the certificate is valid until"));
  EXPECT_THAT(found, HasSubstr("the coordinator answers, with version"));
  EXPECT_THAT(found, HasSubstr("the clocks of this machine and the coordinator agree"));
  EXPECT_THAT(found, HasSubstr("1 worker connected"));
  EXPECT_THAT(found,
              HasSubstr(address() + ", for workers and commands, is open to only this machine, encrypted"));
  EXPECT_THAT(found, HasSubstr("GB are free on the disk"));
}

TEST_F(Doctor, PrintsForPeopleWhatIsWrongAndWhatToDo) {
  StartCoordinator();
  LogIn();
  coordinator().Signal(SIGTERM);
  EXPECT_EQ(coordinator().Wait(), 0);
  const Outcome outcome = Tessera({"doctor"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.output, HasSubstr("login \"studio\" (" + address() + ")\n"));
  EXPECT_THAT(outcome.output, HasSubstr("problem  connection refused: no program listens there\n"));
  EXPECT_THAT(outcome.output, HasSubstr("-> start tessera-coordinator there"));
  EXPECT_THAT(outcome.output, HasSubstr(" problem"));
}

TEST_F(Doctor, NamesKeysThatOthersCanRead) {
  StartCoordinator();
  LogIn();
  RunShell(folder(),
           "chmod 644 " + LoginFolder() + "/identity.pem; chmod 755 data; chmod 640 data/identity/*");
  EXPECT_THAT(ExamineLogin(), HasSubstr("identity.pem (mode 644) -> run: chmod go= "));
  const std::string found = Examine({"data directory " + Path("data")});
  EXPECT_THAT(found, HasSubstr("data (mode 755)"));
  EXPECT_THAT(found, HasSubstr("authority.pem (mode 640)"));
}

TEST_F(Doctor, DistinguishesWaysInWhichACoordinatorIsNotReached) {
  StartCoordinator();
  LogIn();
  const std::string own_address = address();
  Write("config/tessera/farms/studio/address", "no-such-host.invalid:7700\n");
  EXPECT_THAT(ExamineLogin(), HasSubstr("getent hosts no-such-host.invalid"));
  const ListeningSocket silent(8);
  Write("config/tessera/farms/studio/address", silent.address() + "\n");
  EXPECT_THAT(ExamineLogin(), HasSubstr("the TLS handshake failed (timed out)"));
  EXPECT_THAT(ExamineLogin(), HasSubstr("another program listens there"));
  Write("config/tessera/farms/studio/address", own_address + "\n");
  coordinator().Signal(SIGTERM);
  EXPECT_EQ(coordinator().Wait(), 0);
  RunShell(folder(), "mv data other");
  StartCoordinator();
  EXPECT_THAT(ExamineLogin(), HasSubstr("is not one of the farm that the login \"studio\" is for"));
}

TEST_F(Doctor, NamesCertificatesThatExpiredOrWereRevoked) {
  StartCoordinator();
  LogIn();
  const Outcome members = AsOperator("tessera", "access --json");
  const std::string id = nlohmann::json::parse(members.output)["members"][0]["id"];
  EXPECT_EQ(AsOperator("tessera", "access --revoke " + id).code, 0);
  EXPECT_THAT(ExamineLogin(), HasSubstr("was revoked"));
  const UnixTime last_year = UnixNow() - 365 * 24 * 3600;
  const Authority authority = Authority::Make("farm", last_year);
  const PrivateKey key = PrivateKey::Generate();
  CertificateTerms terms;
  terms.uri = Subject{Role::kUser, MemberId{7}, {}, {}}.Uri();
  terms.lifetime = std::chrono::hours(24);
  terms.serial = 7;
  ASSERT_TRUE(LoginStore(Path("config/tessera/farms"))
                  .Save("studio", address(),
                        {key, authority.Issue(key, terms, last_year).Pem(), authority.certificate().Pem()}));
  const std::string found = ExamineLogin();
  EXPECT_THAT(found, HasSubstr("problem the certificate expired on"));
  EXPECT_THAT(found, HasSubstr("ask an operator of the farm for a token and join again"));
}

TEST_F(Doctor, NamesAddressesThatAreOpenInPlainText) {
  StartCoordinator({"--insecure"});
  EXPECT_THAT(
      Examine({ThisCoordinator()}),
      HasSubstr("warning " + address() + ", for workers and commands, is open to only this machine, but"));
  // Another program of that name that listens to everybody.
  RunShell(folder(), "ln -s /usr/bin/python3 tessera-coordinator");
  Process open(folder(), Path("tessera-coordinator"),
               {"-u", "-c",
                "import socket,sys,time\n"
                "s=socket.create_server(('0.0.0.0',0)); print('listens', file=sys.stderr); time.sleep(600)"});
  ASSERT_TRUE(open.AwaitErrors("listens"));
  EXPECT_THAT(Examine({fmt::format("coordinator (process {})", open.pid())}),
              HasSubstr("is open to other machines in plain text, without a login"));
}

TEST_F(Doctor, NamesTheWebPageAndWhetherItIsEncrypted) {
  StartCoordinator({"--https", "127.0.0.1:0", "--http", "127.0.0.1:0"});
  const std::string found = Examine({ThisCoordinator()});
  EXPECT_THAT(found,
              HasSubstr(address() + ", for workers and commands, is open to only this machine, encrypted, "
                                    "to holders of certificates and tokens"));
  EXPECT_THAT(found, HasSubstr(", the web page, is open to only this machine, encrypted, to holders of "
                               "certificates and people who log in with a token"));
  EXPECT_THAT(found,
              HasSubstr(", the web page, is open to only this machine, in plain text; its other users may "
                        "look at jobs and workers there"));
}

TEST_F(Doctor, NamesLimitsThatAreTooLow) {
  EXPECT_THAT(
      Examine({"this machine"}, "", "ulimit -n 512;"),
      HasSubstr("warning a process may open 512 files -> a coordinator here can have a few hundred workers"));
}

TEST_F(Doctor, NamesClocksThatDiffer) {
#ifndef TESSERA_CLOCK_SHIFT_LIBRARY
  GTEST_SKIP() << "sanitizers come before preloaded libraries";
#else
  StartCoordinator();
  LogIn();
  const auto with_shift = [&](int seconds) {
    return Examine(
        {"login \"studio\""}, "",
        fmt::format("TESSERA_TEST_CLOCK_SHIFT_S={} LD_PRELOAD={}", seconds, TESSERA_CLOCK_SHIFT_LIBRARY));
  };
  EXPECT_THAT(with_shift(-300), HasSubstr("warning the coordinator's clock is 30"));
  EXPECT_THAT(with_shift(-300), HasSubstr("s ahead of that of this machine -> synchronise the clocks"));
  EXPECT_THAT(with_shift(3000), HasSubstr("problem the coordinator's clock is 3"));
#endif
}

TEST_F(Doctor, ExaminesTheFoldersThatAreNamed) {
  EXPECT_THAT(Examine({"data directory"}, "--data-dir " + Path("none")),
              HasSubstr("there is no such folder"));
  StartCoordinator();
  const std::string state = Path("elsewhere");
  Process& worker = StartUnaddressedWorker("blade", {"--join", Token("worker"), "--state-dir", state});
  ASSERT_TRUE(worker.AwaitErrors("connected worker="));
  EXPECT_THAT(Examine({"worker of"}, "--state-dir " + state), HasSubstr("the coordinator answers"));
  EXPECT_THAT(Examine({"coordinator " + address()}, "--coordinator " + address()),
              HasSubstr("the coordinator answers"));
}

}  // namespace
}  // namespace tessera
