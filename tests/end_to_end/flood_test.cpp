// Strangers who connect in masses do not disturb the farm.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "proto/wire/address.h"
#include "tests/bench/flood.h"
#include "tests/end_to_end/membership_fixture.h"
#include "tests/sanitizers.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// Two descriptors of each connection that is pending, and something for those that are being closed.
constexpr std::ptrdiff_t kDescriptorsMax = 128 * 2 + 64;
constexpr int kFloodConnections = 700;
constexpr size_t kMemoryMax = size_t{64} << 20;

class FloodedFarm : public MembershipOfAFarm {
 protected:
  Address Victim() const { return *ParseAddress(address(), "coordinator"); }
  std::string Proc() { return "/proc/" + std::to_string(coordinator().pid()); }
  std::ptrdiff_t Descriptors() {
    return std::distance(std::filesystem::directory_iterator(Proc() + "/fd"), {});
  }
  // The most memory that the coordinator has had.
  size_t PeakBytes() {
    std::ifstream status(Proc() + "/status");
    for (std::string word; status >> word;) {
      if (word == "VmHWM:" && status >> word) return std::stoul(word) << 10;
    }
    return 0;
  }
};

TEST_F(FloodedFarm, AFloodFromOneAddressDisturbsNoJobOfOthers) {
  const std::string oracle = Oracle(BoxScene(), {"--spp", "64"});
  const std::ptrdiff_t descriptors = Descriptors();
  const size_t memory = PeakBytes();
  std::optional<Flood> flood(std::in_place, Victim(), kFloodConnections, "127.0.0.2");
  EXPECT_TRUE(Eventually([&] { return flood->opened() > 1000; }));
  LogIn("ada", "user");
  Process& worker = JoinWorker("blade", Token({"--role", "worker"}));
  ASSERT_TRUE(worker.AwaitErrors("connected worker=")) << worker.Errors();
  const Outcome outcome = As("ada", "submit " + BoxScene() + " --spp 64 --watch");
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_EQ(As("ada", "fetch 1 -o farm.exr").code, 0);
  EXPECT_EQ(Bytes("farm.exr"), oracle);
  EXPECT_LT(Descriptors() - descriptors, kDescriptorsMax);
  RecordProperty("connections", static_cast<int>(flood->opened()));
  EXPECT_EQ(flood->answered(), 0u);
  RecordProperty("memory_kb", static_cast<int>((PeakBytes() - memory) >> 10));
  EXPECT_LT(PeakBytes() - memory, MemoryBound(kMemoryMax));
  EXPECT_THAT(coordinator().Errors(), HasSubstr("too many handshakes from there"));
  flood.reset();
  worker.Signal(SIGTERM);
  EXPECT_EQ(worker.Wait(), 0);
  EXPECT_TRUE(Eventually([&] { return Descriptors() <= descriptors + 4; }))
      << Descriptors() << " " << descriptors;
}

// As in a network behind one address.
TEST_F(FloodedFarm, AMemberWithTheAddressOfAFloodGetsThrough) {
  LogIn("ada", "user");
  const Flood flood(Victim(), kFloodConnections, "127.0.0.1");
  EXPECT_TRUE(Eventually([&] { return flood.opened() > 1000; }));
  const Outcome outcome = As("ada", "jobs --patience 100");
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
}

}  // namespace
}  // namespace tessera
