#include "worker/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::HasSubstr;

Result<CommandLineOf<WorkerOptions>> Parse(std::vector<std::string> words) {
  words.insert(words.begin(), {"--coordinator", "127.0.0.1:7700"});
  return ParseWorkerCommandLine(words);
}

TEST(WorkerOptions, RefuseNumbersThatAreNone) {
  for (const char* word : {"-1", "nan", "inf", "1e400", "0x10", "", "99999999999999999999999"}) {
    for (const char* flag : {"--threads", "--cache-size"}) {
      const auto parsed = Parse({std::string(flag) + "=" + word});
      ASSERT_FALSE(parsed) << flag << " " << word;
      EXPECT_EQ(parsed.error().kind, ErrorKind::kBadInput);
      EXPECT_THAT(parsed.error().message, HasSubstr(flag));
    }
  }
  EXPECT_EQ(Parse({"--cache-size", "1.5G"})->options.cache_bytes, uint64_t{1536} << 20);
}

TEST(WorkerOptions, TakeAnyNameThatFitsOnACommandLine) {
  for (const std::string& name : {std::string("caf\xe9"), std::string(10'000, 'x'), std::string("a\nb")})
    EXPECT_TRUE(Parse({"--name", name}));
}

}  // namespace
}  // namespace tessera
