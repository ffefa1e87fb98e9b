#include "worker/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

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

// Flags before the environment, and certificates of an organisation before a token.
TEST(WorkerOptions, TheTokenMayComeFromTheEnvironment) {
  const JoinToken token = JoinToken::Make("127.0.0.1:7711", {}),
                  other = JoinToken::Make("127.0.0.1:7722", {});
  ::setenv("TESSERA_JOIN_TOKEN", token.Text().c_str(), 1);
  EXPECT_EQ(Parse({})->options.join, token);
  EXPECT_EQ(Parse({})->options.coordinator->Text(), token.address);
  EXPECT_EQ(Parse({"--join", other.Text()})->options.join, other);
  EXPECT_FALSE(Parse({"--insecure"})->options.join);
  EXPECT_FALSE(Parse({"--tls-cert", "c", "--tls-key", "k", "--tls-ca", "a"})->options.join);
  ::setenv("TESSERA_JOIN_TOKEN", "tessera-x", 1);
  EXPECT_THAT(Parse({}).error().message, testing::StartsWith("$TESSERA_JOIN_TOKEN: "));
  ::unsetenv("TESSERA_JOIN_TOKEN");
  EXPECT_FALSE(Parse({})->options.join);
}

}  // namespace
}  // namespace tessera
