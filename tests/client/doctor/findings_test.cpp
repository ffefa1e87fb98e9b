#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "client/doctor/facts_findings.h"
#include "client/doctor/file_checks.h"
#include "client/doctor/listening_sockets.h"
#include "client/doctor/machine_checks.h"
#include "proto/identity/authority.h"
#include "proto/probe.h"
#include "tests/listening_socket.h"

namespace tessera {
namespace {

using std::chrono::hours;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr UnixTime kExamined = 1'800'000'000;
constexpr UnixTime kDay_s = 24 * 3600;

TEST(Probe, AMachineThatRendersOtherBitsIsAProblem) {
  EXPECT_EQ(CheckProbe("here", Digest::FromHex(kProbeDigest).value()).severity, Severity::kGood);
  const Digest other = Sha256("other bits");
  const Finding differs = CheckProbe("here", other);
  EXPECT_EQ(differs.severity, Severity::kProblem);
  EXPECT_THAT(differs.what, HasSubstr(other.Hex()));
  EXPECT_THAT(differs.what, HasSubstr(std::string(kProbeDigest)));
  EXPECT_EQ(CheckProbe("here", Failed("no scene")).severity, Severity::kProblem);
}

// ---- Files
// ----------------------------------------------------------------------------------------------------

class PrivateThings : public testing::Test {
 protected:
  PrivateThings() {
    folder_ = testing::TempDir() + "tessera-doctor-XXXXXX";
    EXPECT_NE(::mkdtemp(folder_.data()), nullptr);
    std::ofstream(Key()) << "key";
    SetMode(Key(), 0600);
  }
  ~PrivateThings() override { std::filesystem::remove_all(folder_); }
  std::string Key() const { return folder_ + "/identity.pem"; }
  static void SetMode(const std::string& path, mode_t mode) { ASSERT_EQ(::chmod(path.c_str(), mode), 0); }

  std::string folder_;
};

TEST_F(PrivateThings, OfThisUserAloneAreNoFinding) {
  EXPECT_THAT(CheckPrivacy("here", folder_), IsEmpty());
}

TEST_F(PrivateThings, ThatOthersCanReadOrChangeAreNamedWithTheRemedy) {
  SetMode(Key(), 0640);
  Findings found = CheckPrivacy("here", folder_);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].severity, Severity::kProblem);
  EXPECT_THAT(found[0].what, HasSubstr("identity.pem (mode 640)"));
  EXPECT_THAT(found[0].remedy, HasSubstr("chmod go= " + Key()));
  SetMode(folder_, 0711);
  EXPECT_THAT(CheckPrivacy("here", folder_), SizeIs(2));
}

TEST_F(PrivateThings, ThatAreMissingAreNamed) {
  EXPECT_THAT(CheckPrivacy("here", folder_ + "/none").at(0).what, HasSubstr("none: No such file"));
}

TEST(CertificateTimes, NearAndPastTheirEndAreFindings) {
  const Authority authority = Authority::Make("farm", kExamined);
  CertificateTerms terms;
  terms.lifetime = hours(90 * 24);
  terms.serial = 2;
  const Certificate certificate = authority.Issue(PrivateKey::Generate(), terms, kExamined);
  const auto at = [&](UnixTime days) {
    return CheckTimes("here", "the certificate", certificate, kExamined + days * kDay_s, "join again");
  };
  EXPECT_EQ(at(0).severity, Severity::kGood);
  EXPECT_EQ(at(75).severity, Severity::kGood);
  EXPECT_EQ(at(77).severity, Severity::kWarning);
  EXPECT_THAT(at(77).what, HasSubstr("expires soon, on 2027-04-15"));
  EXPECT_EQ(at(91).severity, Severity::kProblem);
  EXPECT_EQ(at(91).remedy, "join again");
  EXPECT_EQ(at(-1).severity, Severity::kProblem);
  EXPECT_THAT(at(-1).remedy, HasSubstr("clock"));
}

TEST(DiskSpace, IsLowBelowAGibibyteOrATwentiethAndMissingBelowTheNeedsOfTheJournal) {
  constexpr uint64_t kMega = 1 << 20;
  EXPECT_EQ(SeverityOfSpace(2000 * kMega, 100'000 * kMega), Severity::kGood);
  EXPECT_EQ(SeverityOfSpace(1000 * kMega, 100'000 * kMega), Severity::kWarning);
  EXPECT_EQ(SeverityOfSpace(63 * kMega, 100'000 * kMega), Severity::kProblem);
  EXPECT_EQ(SeverityOfSpace(60 * kMega, 1000 * kMega), Severity::kGood);
  EXPECT_EQ(SeverityOfSpace(40 * kMega, 1000 * kMega), Severity::kProblem);
}

// ---- Sockets
// --------------------------------------------------------------------------------------------------

TEST(KernelAddresses, AreReadAsTheKernelPrintsThem) {
  EXPECT_EQ(ParseKernelAddress("0100007F:1E14")->Text(), "127.0.0.1:7700");
  EXPECT_EQ(ParseKernelAddress("00000000:1E14")->Text(), "0.0.0.0:7700");
  EXPECT_EQ(ParseKernelAddress("00000000000000000000000001000000:0050")->Text(), "[::1]:80");
  for (const char* text : {"", ":", "0100007F", "0100007F:", "0100007F:xy", "01007F:1E14", "0100007F:1E14 "})
    EXPECT_FALSE(ParseKernelAddress(text)) << text;
}

TEST(ListeningSockets, OfThisProcessAreFound) {
  const ListeningSocket socket(1);
  std::vector<std::string> found;
  for (const Address& each : ListeningAddresses(::getpid())) found.push_back(each.Text());
  EXPECT_THAT(found, testing::Contains(socket.address()));
  EXPECT_THAT(ListeningAddresses(1 << 30), IsEmpty());
}

// ---- Answers of a coordinator
// -------------------------------------------------------------------------------------

class Answers : public testing::Test {
 protected:
  Answers() {
    facts_.software_version = kSoftwareVersion;
    facts_.protocol = kProtocolVersion;
    facts_.has_clock = true;
    facts_.answer_s = 0.1;
  }
  Severity Worst() const {
    Severity worst = Severity::kGood;
    for (const Finding& each : FindingsOf("there", facts_)) worst = std::max(worst, each.severity);
    return worst;
  }
  std::string Text() const {
    std::string text;
    for (const Finding& each : FindingsOf("there", facts_)) text += each.what + " " + each.remedy + "\n";
    return text;
  }
  CoordinatorFacts facts_;
};

TEST_F(Answers, OfAHealthyFarmAreGood) {
  WorkerStatus worker;
  worker.software_version = kSoftwareVersion;
  facts_.workers = {worker};
  EXPECT_EQ(Worst(), Severity::kGood) << Text();
}

TEST_F(Answers, ClocksThatDifferAreNamedInBothDirections) {
  for (const double ahead : {-20.0, 20.0, 1000.0}) {
    facts_.clock_ahead_s = ahead;
    EXPECT_EQ(Worst(), Severity::kWarning) << ahead;
  }
  facts_.clock_ahead_s = -4000;
  EXPECT_EQ(Worst(), Severity::kProblem);
  EXPECT_THAT(Text(), HasSubstr("the coordinator's clock is 4000.0 s behind that of this machine"));
  facts_.clock_ahead_s = 12;
  facts_.answer_s = 9;  // too slow an answer to know
  EXPECT_EQ(Worst(), Severity::kGood);
  facts_.clock_ahead_s = 4000;
  facts_.has_clock = false;
  EXPECT_EQ(Worst(), Severity::kGood);
}

TEST_F(Answers, OtherVersionsAndQuarantinedWorkersAreNamed) {
  facts_.software_version = "0.1";
  EXPECT_EQ(Worst(), Severity::kProblem);
  EXPECT_THAT(Text(), HasSubstr("version 0.1"));
  facts_.software_version = kSoftwareVersion;
  facts_.protocol = kProtocolVersion - 1;
  EXPECT_EQ(Worst(), Severity::kProblem);
  EXPECT_THAT(Text(), HasSubstr(fmt::format("(protocol {}), this program", kProtocolVersion - 1)));
  facts_.protocol = kProtocolVersion;
  WorkerStatus old, ill;
  old.name = "blade-1";
  old.software_version = "0.1";
  ill.name = "blade-2";
  ill.software_version = kSoftwareVersion;
  ill.quarantined = true;
  ill.reason = "wrong bits";
  facts_.workers = {ill};
  EXPECT_EQ(Worst(), Severity::kWarning);
  EXPECT_THAT(Text(), HasSubstr("worker blade-2 is quarantined: wrong bits"));
  facts_.workers = {old, ill};
  EXPECT_EQ(Worst(), Severity::kProblem);
  EXPECT_THAT(Text(), HasSubstr("worker blade-1 has version 0.1"));
}

}  // namespace
}  // namespace tessera
