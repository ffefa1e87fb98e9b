// A farm of several machines whose network has faults.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <fstream>

#include "tests/hosts/farm_on_hosts.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

// ---- From nothing to a picture
// -----------------------------------------------------------------------------

// The lines of the first block of commands after a heading of the guide, without their comments.
std::vector<std::string> LinesOfGuide(const std::string& heading) {
  std::ifstream page(SourceDir() + "/client/guide/farm.md");
  std::vector<std::string> lines;
  bool is_in_section = false, is_in_block = false;
  for (std::string line; std::getline(page, line);) {
    if (line == heading) is_in_section = true;
    if (!is_in_section) continue;
    if (line.starts_with("```")) {
      if (is_in_block) return lines;
      is_in_block = true;
      continue;
    }
    if (is_in_block) lines.push_back(line.substr(0, line.find(" #")));
  }
  return lines;
}

// Without the & that puts it into the background.
std::string InForeground(std::string line) {
  line.erase(line.find_last_not_of(" &") + 1);
  return line;
}

std::string WithToken(std::string line, const std::string& token) {
  const std::string word = "TOKEN";
  return line.replace(line.find(word), word.size(), token);
}

TEST_F(FarmOnHosts, TheLinesOfTheGuideLeadFromNothingToAPictureRenderedByTwoOtherHosts) {
  const std::vector<std::string> lines = LinesOfGuide("## A farm of several machines");
  ASSERT_THAT(lines, SizeIs(3));
  int typed = 1;
  Process& coordinator = Type(kCoordinatorHost, InForeground(lines[0]));
  ASSERT_TRUE(coordinator.AwaitErrors("tessera-worker --join TOKEN")) << coordinator.Errors();
  const std::string token = coordinator.Output().substr(0, coordinator.Output().find('\n'));
  for (const int host : {kFirstWorker, kSecondWorker}) {
    ++typed;
    Type(host, InForeground(WithToken(lines[1], token)));
  }
  ++typed;
  PutScene(kCoordinatorHost);
  const Outcome rendered = TypeAndWait(kCoordinatorHost, lines[2]);
  EXPECT_EQ(rendered.code, 0) << rendered.errors;
  EXPECT_LE(typed, 4);
  PutScene(kUserHost);
  EXPECT_EQ(Bytes("host-0/picture.exr"), Expected(""));
}

// ---- Networks that are slow
// ----------------------------------------------------------------------------------

struct Condition {
  const char* name;
  LinkTerms terms;
};

class FarmOnASlowNetwork : public FarmOnHosts, public testing::WithParamInterface<Condition> {};

constexpr const char* kFrame = "--resolution 128x128 --tile-size 32 --spp 64";

TEST_P(FarmOnASlowNetwork, RendersTheSameBits) {
  StartFarm();
  const std::string expected = Expected(kFrame);
  network().SetTerms(GetParam().terms);
  const uint64_t bytes_before = network().bytes_carried();
  const auto begin = std::chrono::steady_clock::now();
  const Outcome outcome = TypeAndWait(
      kUserHost, fmt::format("tessera fetch $(tessera submit scene.pbrt --watch {}) -o farm.exr", kFrame));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  ASSERT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_EQ(Bytes("host-3/farm.exr"), expected);
  network().SetTerms({});
  const Outcome workers = TypeAndWait(kUserHost, "tessera workers");
  EXPECT_THAT(workers.output, HasSubstr("host-1"));
  EXPECT_THAT(workers.output, HasSubstr("host-2"));
  fmt::print("condition={} seconds={:.1f} kilosamples_per_s={:.0f} megabytes={:.1f}\n", GetParam().name,
             took.count(), JobFigure("samples_total").value() / took.count() / 1e3,
             static_cast<double>(network().bytes_carried() - bytes_before) / 1e6);
}

using std::chrono::milliseconds;
INSTANTIATE_TEST_SUITE_P(
    Conditions, FarmOnASlowNetwork,
    testing::Values(Condition{"Undisturbed", {}},
                    Condition{"Latency50msLoss1Percent", {.latency = milliseconds(50), .loss = 0.01}},
                    Condition{"Rate10MbitPerSecond", {.latency = milliseconds(1), .bits_per_s = 10e6}}),
    [](const auto& test) { return std::string(test.param.name); });

// ---- Hosts that vanish
// -----------------------------------------------------------------------------------------

constexpr const char* kLongFrame = "--resolution 128x128 --tile-size 32 --spp 128";

TEST_F(FarmOnHosts, AHostThatDiesInMidFrameCostsTimeOnly) {
  StartFarm();
  const std::string expected = Expected(kLongFrame);
  Process& submit = Type(kUserHost, fmt::format("tessera submit scene.pbrt --watch {}", kLongFrame));
  AwaitShareOfJob(0.1);
  network().CutOff(kSecondWorker);  // first: its end must not be seen by the others
  worker(kSecondWorker).Signal(SIGKILL);
  EXPECT_EQ(submit.Wait(), 0) << submit.Errors();
  EXPECT_EQ(TypeAndWait(kUserHost, "tessera fetch 1 -o farm.exr").code, 0);
  EXPECT_EQ(Bytes("host-3/farm.exr"), expected);
}

TEST_F(FarmOnHosts, APartitionInOneDirectionInMidFrameHealsByItself) {
  StartFarm();
  const std::string expected = Expected(kLongFrame);
  Process& submit = Type(kUserHost, fmt::format("tessera submit scene.pbrt --watch {}", kLongFrame));
  AwaitShareOfJob(0.1);
  network().Block(kSecondWorker, kCoordinatorHost, true);  // answers still reach the worker
  AwaitShareOfJob(0.4);
  network().Block(kSecondWorker, kCoordinatorHost, false);
  EXPECT_EQ(submit.Wait(), 0) << submit.Errors();
  EXPECT_EQ(TypeAndWait(kUserHost, "tessera fetch 1 -o farm.exr").code, 0);
  EXPECT_EQ(Bytes("host-3/farm.exr"), expected);
  EXPECT_TRUE(IsAlive(worker(kSecondWorker).pid()));
  // It has its place again.
  EXPECT_TRUE(Eventually(
      [&] { return TypeAndWait(kUserHost, "tessera workers").output.find("host-2") != std::string::npos; }));
}

TEST_F(FarmOnHosts, TheHostOfTheCoordinatorMayBeCutOffInMidFrame) {
  StartFarm();
  const std::string expected = Expected(kLongFrame);
  Process& submit =
      Type(kUserHost, fmt::format("tessera submit scene.pbrt --watch --patience 120 {}", kLongFrame));
  AwaitShareOfJob(0.1);
  for (const int host : {kFirstWorker, kSecondWorker, kUserHost}) {
    network().Block(kCoordinatorHost, host, true);
    network().Block(host, kCoordinatorHost, true);
  }
  EXPECT_TRUE(worker(kFirstWorker).AwaitErrors("coordinator_unreachable"));
  for (const int host : {kFirstWorker, kSecondWorker, kUserHost}) {
    network().Block(kCoordinatorHost, host, false);
    network().Block(host, kCoordinatorHost, false);
  }
  EXPECT_EQ(submit.Wait(), 0) << submit.Errors();
  EXPECT_EQ(TypeAndWait(kUserHost, "tessera fetch 1 -o farm.exr").code, 0);
  EXPECT_EQ(Bytes("host-3/farm.exr"), expected);
}

TEST_F(FarmOnHosts, ADoctorTellsAFirewallFromACoordinatorThatIsNotThere) {
  StartFarm();
  EXPECT_EQ(TypeAndWait(kUserHost, "tessera doctor").code, 0);
  network().Block(kUserHost, kCoordinatorHost, true);
  const Outcome blocked = TypeAndWait(kUserHost, "tessera doctor");
  EXPECT_EQ(blocked.code, 1);
  EXPECT_THAT(blocked.output, HasSubstr("problem  timed out: the machine does not answer"));
  EXPECT_THAT(blocked.output,
              HasSubstr("a firewall drops the packets, or the machine is off: allow TCP port 7700"));
  network().Block(kUserHost, kCoordinatorHost, false);
  EXPECT_EQ(TypeAndWait(kUserHost, "tessera doctor").code, 0);
}

// ---- Strangers
// -----------------------------------------------------------------------------------------------

TEST_F(FarmOnHosts, AHostWithoutACertificateGetsNoAnswer) {
  StartFarm();
  const std::string address = Network::Address(kCoordinatorHost) + ":7700";
  const Outcome refused = TypeAndWait(kFirstWorker, "tessera jobs --coordinator " + address);
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("ask its operator for a token"));
  // In plain text: not one byte.
  const std::string greeting = "printf 'PRI * HTTP/2.0\\r\\n\\r\\nSM\\r\\n\\r\\n\\0\\0\\0\\4\\0\\0\\0\\0\\0'";
  const Outcome plain = TypeAndWait(
      kFirstWorker, fmt::format("trap '' PIPE; exec 3<>/dev/tcp/{}/7700; {} >&3; timeout 20 cat <&3 | wc -c",
                                Network::Address(kCoordinatorHost), greeting));
  EXPECT_LT(std::stoi(plain.output), 16) << "more than a TLS alert";
}

}  // namespace
}  // namespace tessera
