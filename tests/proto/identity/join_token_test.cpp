#include "proto/identity/join_token.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/identity/subject.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(JoinToken, IsReadBackFromItsText) {
  for (const char* address : {"a:1", "10.0.0.5:7700", "[fe80::1]:7700", "farm.example:7700"}) {
    const JoinToken token = JoinToken::Make(address, Sha256("authority"));
    const auto read = JoinToken::Parse(token.Text());
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, token);
    EXPECT_EQ(read->Key().PublicDigest(), token.Key().PublicDigest());
  }
}

TEST(JoinToken, IsOneShortWord) {
  const std::string text = JoinToken::Make("10.0.0.5:7700", Sha256("authority")).Text();
  EXPECT_LT(text.size(), 100u);
  EXPECT_EQ(text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"),
            std::string::npos);
}

TEST(JoinToken, EveryTokenHasAKeyOfItsOwn) {
  const JoinToken one = JoinToken::Make("a:1", {}), other = JoinToken::Make("a:1", {});
  EXPECT_NE(one.Key().PublicDigest(), other.Key().PublicDigest());
}

TEST(JoinToken, TheCertificateShowsTheKeyAndNoSecret) {
  const JoinToken token = JoinToken::Make("a:1", Sha256("authority"));
  const Certificate certificate = token.MakeCertificate(1'800'000'000);
  EXPECT_EQ(certificate.KeyDigest(), token.Key().PublicDigest());
  const auto subject = Subject::Parse(certificate.Uri());
  ASSERT_TRUE(subject);
  EXPECT_FALSE(subject->IsMember());
  EXPECT_EQ(subject->token_key, token.Key().PublicDigest());
}

TEST(JoinToken, AWordThatWasNotCopiedWholeIsRefused) {
  const std::string text = JoinToken::Make("farm.example:7700", Sha256("authority")).Text();
  for (size_t size = 0; size < text.size(); ++size)
    EXPECT_FALSE(JoinToken::Parse(text.substr(0, size))) << size;
  for (size_t at = 8; at + 1 < text.size(); ++at) {
    std::string changed = text;
    changed[at] = changed[at] == 'A' ? 'B' : 'A';
    EXPECT_FALSE(JoinToken::Parse(changed)) << at;
  }
  EXPECT_THAT(JoinToken::Parse("tessera-!").error().message, HasSubstr("damaged"));
  EXPECT_FALSE(JoinToken::Parse("tessera-" + std::string(100'000, 'A')));
}

}  // namespace
}  // namespace tessera
