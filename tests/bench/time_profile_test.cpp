#include "tests/bench/time_profile.h"

#include <gmock/gmock.h>

#include <sys/mman.h>

#include <cstring>
#include <ctime>
#include <vector>

#include "tests/bench/process_cost.h"

namespace tessera {
namespace {

using testing::ElementsAre;

TEST(TimeProfile, HelpersBelongToTheBoxThatCallsThem) {
  EXPECT_EQ(PartOfFiles({"/b/include/renderer_math/renderer/math/vec.h", "/usr/include/c++/12/cmath",
                         "/b/include/renderer_bxdf/renderer/bxdf/bsdf.h", "/s/renderer/integrator/path.cpp"}),
            TimePart::kShading);
  EXPECT_EQ(PartOfFiles({"/s/renderer/sampler/sobol.cpp", "/s/renderer/light/light_table.cpp"}),
            TimePart::kSampling);
  EXPECT_EQ(PartOfFiles({"/s/renderer/math/distribution.cpp"}), TimePart::kOther);
  EXPECT_EQ(PartOfFiles({"??"}), TimePart::kOther);
}

TEST(TimeProfile, FilesOfInlinedFunctionsAreReadInOrder) {
  const auto files = ReadAddressFiles(
      "0x0000000000001000\n/s/renderer/math/vec.h:90\n/s/renderer/light/light.cpp:7 (discriminator 3)\n"
      "0x0000000000002000\n??:0\n");
  ASSERT_EQ(files.size(), 2u);
  EXPECT_THAT(files[0], ElementsAre("/s/renderer/math/vec.h", "/s/renderer/light/light.cpp"));
  EXPECT_THAT(files[1], ElementsAre("??"));
}

TEST(TimeProfile, ATimerSamplesWhereTheProcessIs) {
  TimeProfiler profiler;
  volatile double sum = 0;
  // Some ticks of the kernel's clock, of this thread's own time.
  for (const std::clock_t end = std::clock() + CLOCKS_PER_SEC / 5; std::clock() < end;) sum = sum + 1;
  const auto shares = profiler.Finish();
  ASSERT_TRUE(shares) << shares.error().message;
  EXPECT_NEAR(shares->Of(TimePart::kOther), 1, 1e-9);
}

TEST(ProcessCost, InstructionsAreReadWithTheirSeparators) {
  EXPECT_EQ(ReadInstructionCount("==12== \n==12== I   refs:      1,234,567\n"), 1'234'567u);
  EXPECT_EQ(ReadInstructionCount("valgrind: no such program"), 0u);
}

TEST(ProcessCost, ThePeakOfMemoryFallsWhenItIsReset) {
  constexpr size_t kBytes = 200 << 20;
  void* const large = ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(large, MAP_FAILED);
  std::memset(large, 1, kBytes);
  ::munmap(large, kBytes);
  const double before = PeakMemory();
  ResetPeakMemory();
  EXPECT_LT(PeakMemory(), before - 100);
}

}  // namespace
}  // namespace tessera
