#include <gmock/gmock.h>

#include <cstdio>

#include "client/commands/command_line.h"
#include "client/commands/commands.h"

namespace tessera {
namespace {

using testing::HasSubstr;

std::string Output(const std::vector<std::string>& words) {
  const auto line = ParseCommandLine({KindsCommand()}, words);
  if (!line) return line.error().message;
  Cancellation cancellation;
  testing::internal::CaptureStdout();
  const Result<int> code = line->run(cancellation);
  std::fflush(stdout);
  EXPECT_TRUE(code.has_value() && *code == 0);
  return testing::internal::GetCapturedStdout();
}

TEST(KindsCommand, ListsTheKindsOfEachFamilyByTheirSupport) {
  const std::string text = Output({"kinds"});
  EXPECT_THAT(
      text,
      HasSubstr("spectrum texture\n"
                "  supported      bilerp, checkerboard, constant, directionmix, dots, imagemap, marble, "
                "mix, scale\n"
                "  not supported  ptex\n"));
  EXPECT_THAT(text, HasSubstr("  replaced       bdpt (volpath), "));
}

TEST(KindsCommand, PrintsJson) {
  const std::string json = Output({"kinds", "--json"});
  EXPECT_THAT(json, HasSubstr(R"("camera":[{"name":"perspective","support":"supported"},)"));
  EXPECT_THAT(json, HasSubstr(R"({"name":"bdpt","support":"replaced","instead":"volpath"})"));
  EXPECT_THAT(json, HasSubstr(R"({"name":"ptex","support":"not supported"})"));
}

}  // namespace
}  // namespace tessera
