// A farm that uses certificates of an organisation, made with openssl as the guide shows
// (client/guide/access.md).
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>

#include "proto/identity/certificate.h"
#include "proto/wire/reachability.h"
#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class FarmOfAnOrganisation : public EndToEnd {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/usr/bin/openssl")) GTEST_SKIP() << "/usr/bin/openssl is missing";
    MakeAuthority("ca");
    MakeCertificate("server", "DNS:localhost,IP:127.0.0.1", "serverAuth");
    MakeCertificate("ada", "URI:tessera:user/ada", "clientAuth");
  }

  void OpenSsl(const std::string& words) const {
    const Outcome outcome = RunProgram(folder(), "/bin/bash", {"-c", "openssl " + words});
    ASSERT_EQ(outcome.code, 0) << words << outcome.errors;
  }
  void MakeAuthority(const std::string& name) const {
    OpenSsl(
        fmt::format("req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 365 -subj /CN={0} "
                    "-keyout {0}.key -out {0}.pem",
                    name));
  }
  // NAME.key and NAME.pem, of the authority in `issuer`.pem.
  void MakeCertificate(const std::string& name, const std::string& alternative_name, const std::string& usage,
                       int days = 90, const std::string& issuer = "ca") const {
    OpenSsl(
        fmt::format("req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN={0} "
                    "-keyout {0}.key -out {0}.csr",
                    name));
    OpenSsl(
        fmt::format("x509 -req -in {0}.csr -CA {4}.pem -CAkey {4}.key -days {3} -out {0}.pem -extfile "
                    "<(printf 'subjectAltName={1}\\nextendedKeyUsage={2}')",
                    name, alternative_name, usage, days, issuer));
  }
  std::vector<std::string> Files(const std::string& name) const {
    return {"--tls-cert", Path(name + ".pem"), "--tls-key", Path(name + ".key"), "--tls-ca", Path("ca.pem")};
  }
  void Start() { StartCoordinator(Files("server")); }
  Outcome As(const std::string& person, std::vector<std::string> words) const {
    for (const std::string& each : Files(person)) words.push_back(each);
    words.insert(words.end(), {"--coordinator", address(), "--patience", "5"});
    return Tessera(words);
  }
};

TEST_F(FarmOfAnOrganisation, MembersWithItsCertificatesRenderAJob) {
  Start();
  MakeCertificate("blade", "URI:tessera:worker/blade", "clientAuth");
  Process& worker = StartWorker("blade", 1, Files("blade"));
  ASSERT_TRUE(worker.AwaitErrors("connected worker=")) << worker.Errors();
  const std::string oracle = Oracle(BoxScene(), {"--spp", "8"});
  const Outcome submitted = As("ada", {"submit", BoxScene(), "--spp", "8", "--watch"});
  EXPECT_EQ(submitted.code, 0) << submitted.errors;
  EXPECT_EQ(As("ada", {"fetch", "1", "-o", "farm.exr"}).code, 0);
  EXPECT_EQ(Bytes("farm.exr"), oracle);
  const Outcome members = Ask({"access"});
  EXPECT_THAT(members.output, HasSubstr("ada"));
  EXPECT_THAT(members.output, HasSubstr("blade"));
}

TEST_F(FarmOfAnOrganisation, MembersWithTokensUseItToo) {
  StartCoordinator({"--tls-cert", Path("server.pem"), "--tls-key", Path("server.key")});
  const Outcome token =
      RunProgram(folder(), "tessera-coordinator", {"token", "--role", "user", "--coordinator", address()});
  ASSERT_EQ(token.code, 0) << token.errors;
  const Outcome login = Tessera({"login", token.output.substr(0, token.output.find('\n'))});
  EXPECT_EQ(login.code, 0) << login.errors;
  const Outcome jobs = Tessera({"jobs"});
  EXPECT_EQ(jobs.code, 0) << jobs.errors;
  // Without --tls-ca, its certificates make nobody a member.
  EXPECT_THAT(As("ada", {"jobs"}).errors, HasSubstr("does not accept the certificate in"));
}

TEST_F(FarmOfAnOrganisation, ClientsCheckTheNameOfTheHost) {
  MakeCertificate("server", "DNS:farm.example", "serverAuth");
  Start();
  const Outcome refused = As("ada", {"jobs"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.errors,
              HasSubstr("the certificate of the coordinator is for farm.example, not for 127.0.0.1"));
}

TEST_F(FarmOfAnOrganisation, ACertificateOfTheFarmsOwnIsNotTakenForOneOfTheOrganisation) {
  StartCoordinator();
  EXPECT_THAT(As("ada", {"jobs"}).errors, HasSubstr("was not issued by an authority in"));
}

TEST_F(FarmOfAnOrganisation, RolesAndRevocationHoldForItsMembers) {
  Start();
  MakeCertificate("vera", "URI:tessera:viewer/vera", "clientAuth");
  EXPECT_EQ(As("vera", {"jobs"}).code, 0);
  EXPECT_THAT(As("vera", {"submit", BoxScene()}).errors, HasSubstr("needs the role user or operator"));
  EXPECT_EQ(Ask({"access", "--revoke", "vera"}).code, 0);
  for (int round = 0; round < 2; ++round) {
    EXPECT_THAT(As("vera", {"jobs"}).errors, HasSubstr("the certificate of viewer \"vera\" was revoked"));
    MakeCertificate("vera", "URI:tessera:viewer/vera", "clientAuth", 365);  // a later one does not help
    Start();
  }
  EXPECT_EQ(As("ada", {"jobs"}).code, 0);
}

TEST_F(FarmOfAnOrganisation, CertificatesThatNameNoMemberAreRefusedBeforeAnythingIsSent) {
  Start();
  for (const char* name :
       {"DNS:ada.example", "URI:tessera:king/ada", "URI:tessera:user/ada,URI:tessera:operator/ada"}) {
    MakeCertificate("eve", name, "clientAuth");
    const Outcome refused = As("eve", {"jobs"});
    EXPECT_EQ(refused.code, 1) << name;
    EXPECT_THAT(refused.errors, HasSubstr("the certificate names no member"));
  }
  MakeAuthority("others");
  MakeCertificate("eve", "URI:tessera:user/eve", "clientAuth", 90, "others");
  EXPECT_THAT(As("eve", {"jobs"}).errors, HasSubstr("does not accept the certificate in"));
}

TEST_F(FarmOfAnOrganisation, FilesThatCannotBeUsedAreNamed) {
  const auto expect_refused = [&](std::vector<std::string> files, int code, const std::string& reason) {
    files.insert(files.end(), {"--listen", "127.0.0.1:0", "--data-dir", Path("data")});
    const Outcome refused = RunProgram(folder(), "tessera-coordinator", files);
    EXPECT_EQ(refused.code, code) << reason;
    EXPECT_THAT(refused.errors, HasSubstr(reason));
  };
  expect_refused({"--tls-cert", Path("server.pem")}, 2, "--tls-cert and --tls-key belong together");
  expect_refused({"--tls-ca", Path("ca.pem")}, 2, "need a coordinator with --tls-cert");
  expect_refused({"--tls-cert", Path("none.pem"), "--tls-key", Path("server.key")}, 2, "none.pem");
  expect_refused({"--tls-cert", Path("server.pem"), "--tls-key", Path("ada.key")}, 1,
                 "does not belong to the key");
  expect_refused(Files("ada"), 1, "cannot be used by a TLS server");
  RunShell(folder(), "chmod 644 server.key");
  expect_refused(Files("server"), 1, "everybody may read this key");
  const Outcome half = Tessera({"jobs", "--coordinator", "127.0.0.1:7700", "--tls-cert", Path("ada.pem")});
  EXPECT_EQ(half.code, 2);
  EXPECT_THAT(half.errors, HasSubstr("belong together"));
}

TEST_F(FarmOfAnOrganisation, CertificatesThatAreReplacedOnDiskAreShownWithoutARestart) {
  Start();
  const auto shown = [&] {
    const auto chain = FetchCertificates(*ParseAddress(address(), "coordinator"));
    return chain ? chain->front().Fingerprint().Hex() : chain.error().message;
  };
  const std::string first = shown();
  RunShell(folder(), "cp server.key old.key");
  MakeCertificate("server", "DNS:localhost,IP:127.0.0.1", "serverAuth");
  const std::string second = Certificate::FromPem(Bytes("server.pem"), "server.pem")->Fingerprint().Hex();
  EXPECT_NE(first, second);
  EXPECT_TRUE(Eventually([&] { return shown() == second; }));
  EXPECT_EQ(As("ada", {"jobs"}).code, 0);
  // A key that does not fit is reported, and the certificate before is shown on.
  RunShell(folder(), "cp old.key server.key");
  EXPECT_TRUE(coordinator().AwaitErrors("does not belong to the key"));
  EXPECT_EQ(As("ada", {"jobs"}).code, 0);
}

}  // namespace
}  // namespace tessera
