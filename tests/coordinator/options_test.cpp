#include "coordinator/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::HasSubstr;

Result<CoordinatorOptions> Parse(const std::vector<std::string>& words) {
  auto parsed = ParseCoordinatorCommandLine(words);
  if (!parsed) return parsed.error();
  EXPECT_EQ(parsed->answer, "");
  return std::move(parsed->options);
}

TEST(CoordinatorOptions, ListensOnEveryAddressGiven) {
  const auto options = Parse({"--listen", "127.0.0.1:80", "--data-dir", "/d", "--listen", "unix:/s"});
  ASSERT_TRUE(options) << options.error().message;
  ASSERT_EQ(options->listen.size(), 2u);
  EXPECT_EQ(options->listen[1].Text(), "unix:/s");
  EXPECT_EQ(options->data_dir, "/d");
  EXPECT_EQ(options->attempts_max, 3);
}

TEST(CoordinatorOptions, PlainTextIsForAddressesOfThisMachineAlone) {
  EXPECT_TRUE(Parse({"--listen", "0.0.0.0:80", "--data-dir", "/d"}));
  EXPECT_TRUE(Parse({"--listen", "127.0.0.1:80", "--data-dir", "/d", "--insecure"}));
  const auto refused = Parse({"--listen", "0.0.0.0:80", "--data-dir", "/d", "--insecure"});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(refused.error().message, HasSubstr("--insecure is for addresses of this machine"));
}

TEST(CoordinatorOptions, TokensToBePrintedNameARoleAndPerhapsTheNumberOfUses) {
  const std::vector<std::string> words{"--listen", "0.0.0.0:80", "--data-dir", "/d"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    return Parse(more);
  };
  const auto options = with({"--token", "worker:20", "--token", "user"});
  ASSERT_TRUE(options) << options.error().message;
  ASSERT_EQ(options->tokens.size(), 2u);
  EXPECT_EQ(options->tokens[0].role, Role::kWorker);
  EXPECT_EQ(options->tokens[0].uses, 20);
  EXPECT_EQ(options->tokens[1].role, Role::kUser);
  EXPECT_EQ(options->tokens[1].uses, 1);
  for (const char* wrong : {"", "king", "worker:", "worker:0", "worker:-1", "worker:1000000", "worker:2:3"})
    EXPECT_FALSE(with({"--token", wrong})) << wrong;
}

TEST(CoordinatorOptions, TokensNeedAnAddressThatOthersCanJoinAt) {
  EXPECT_FALSE(Parse({"--listen", "unix:/s", "--data-dir", "/d", "--token", "user"}));
  EXPECT_FALSE(Parse({"--listen", "127.0.0.1:80", "--insecure", "--data-dir", "/d", "--token", "user"}));
}

TEST(CoordinatorOptions, NamesForOthersMayBeRepeated) {
  const auto options = Parse({"--listen", "0.0.0.0:80", "--data-dir", "/d", "--name-or-address",
                              "farm.example", "--name-or-address", "10.0.0.5"});
  ASSERT_TRUE(options) << options.error().message;
  EXPECT_EQ(options->names, (std::vector<std::string>{"farm.example", "10.0.0.5"}));
}

TEST(CoordinatorOptions, TheWebPagesArePlainOnThisMachineAloneAndEncryptedElsewhere) {
  const auto parse = [](std::vector<std::string> words) {
    words.insert(words.end(), {"--listen", "unix:/s", "--data-dir", "/d", "--http-name", "farm.example"});
    return Parse(words);
  };
  const auto plain = parse({"--http", "127.0.0.1:8080"});
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(plain->http->Text(), "127.0.0.1:8080");
  EXPECT_FALSE(plain->https);
  EXPECT_EQ(plain->http_names, std::vector<std::string>{"farm.example"});
  for (const char* flag : {"--http", "--https"}) {
    const auto open = parse({flag, "0.0.0.0:8080"});
    ASSERT_TRUE(open) << open.error().message;
    EXPECT_FALSE(open->http);
    EXPECT_EQ(open->https->Text(), "0.0.0.0:8080");
    EXPECT_FALSE(parse({flag, "unix:/web"}));
  }
  const auto both = parse({"--http", "localhost:8080", "--https", "127.0.0.1:8443"});
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_TRUE(both->http && both->https);
  EXPECT_FALSE(parse({"--http", "0.0.0.0:8080", "--https", "0.0.0.0:8443"}));
}

TEST(CoordinatorOptions, WithoutCertificatesTheWebPagesAreForThisMachineAlone) {
  const auto parse = [](const char* flag, const char* address) {
    return Parse({"--listen", "unix:/s", "--data-dir", "/d", "--insecure", flag, address});
  };
  EXPECT_TRUE(parse("--http", "127.0.0.1:8080"));
  for (const auto& [flag, address] : {std::pair("--http", "0.0.0.0:8080"), {"--https", "127.0.0.1:8080"}}) {
    const auto refused = parse(flag, address);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(refused.error().message, HasSubstr("the certificates that --insecure turns off"));
  }
}

TEST(CoordinatorOptions, SizeLimitsHaveTheirPresentAndTheirOldNames) {
  for (const auto& [blobs, sums] :
       {std::pair("--blobs-size", "--sums-size"), {"--blob-bytes", "--keep-sums"}}) {
    const auto options = Parse({"--listen", "unix:/s", "--data-dir", "/d", blobs, "1.5G", sums, "500MB"});
    ASSERT_TRUE(options) << options.error().message;
    EXPECT_EQ(options->blob_bytes, uint64_t{1536} << 20);
    EXPECT_EQ(options->keep_sums_bytes, uint64_t{500} << 20);
  }
}

TEST(CoordinatorOptions, HelpShowsTheDefaultsInOneForm) {
  const std::string help = ParseCoordinatorCommandLine({"--help"})->answer;
  EXPECT_THAT(help, HasSubstr("[default: 100G]"));
  EXPECT_THAT(help, HasSubstr("[default: 16G]"));
  EXPECT_THAT(help, HasSubstr("[default: 3]"));
  EXPECT_THAT(help, HasSubstr("[default: info]"));
}

TEST(CoordinatorOptions, AnUnknownFlagIsRefusedWithASuggestion) {
  EXPECT_EQ(Parse({"--listn", "unix:/s", "--data-dir", "/d"}).error().message,
            "unknown flag \"--listn\" (did you mean \"--listen\"?)");
}

TEST(CoordinatorOptions, BadUsageIsRefused) {
  const std::vector<std::string> table[] = {
      {},
      {"--listen", "127.0.0.1:80"},
      {"--data-dir", "/d"},
      {"--listen", "nonsense", "--data-dir", "/d"},
      {"--listen", "127.0.0.1:80", "--data-dir", ""},
      {"--listen", "127.0.0.1:80", "--data-dir", "/d", "--no-such-flag"},
      {"--listen", "127.0.0.1:80", "--data-dir", "/d", "--attempts-max", "0"},
      {"--listen", "127.0.0.1:80", "--data-dir", "/d", "--blobs-size", "1K"},
      {"--listen", "127.0.0.1:80", "--data-dir", "/d", "--sums-size", "-1"},
      {"--listen", "127.0.0.1:80", "--data-dir", "/d", "--log-level", "loud"},
  };
  for (const auto& words : table) {
    const auto options = Parse(words);
    ASSERT_FALSE(options) << testing::PrintToString(words);
    EXPECT_EQ(options.error().kind, ErrorKind::kBadInput);
  }
}

}  // namespace
}  // namespace tessera
