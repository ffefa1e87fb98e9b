#include "coordinator/core/membership_ledger.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <variant>

namespace tessera {
namespace {

using testing::HasSubstr;

constexpr UnixTime kNow = 1'800'000'000;
constexpr UnixTime kHour = 3600, kDay = 24 * kHour;

const Digest kKey = Sha256("key");

TokenStatus Token(uint32_t uses = 1) {
  return {kKey, Role::kWorker, "blade", kNow, kNow + kHour, uses, false};
}

MemberStatus Member(uint64_t id, const Digest& token = kKey) {
  return {MemberId{id}, Role::kWorker, "blade", kNow, kNow + 90 * kDay, token, false};
}

class Membership : public testing::Test {
 protected:
  // The state after a restart that reads `facts`.
  static MembershipLedger RestoredFrom(const std::vector<Fact>& facts, std::vector<Fact>& output) {
    MembershipLedger ledger(output);
    for (const Fact& fact : facts) {
      const Fact read = *DecodeFact(EncodeFact(fact));
      std::visit(
          [&](const auto& each) {
            if constexpr (requires { ledger.Restore(each); }) ledger.Restore(each);
          },
          read);
    }
    return ledger;
  }
  void ExpectSameAfterRestart() {
    std::vector<Fact> snapshot, output;
    ledger_.AppendSnapshot(snapshot);
    for (const std::vector<Fact>& facts : {facts_, snapshot}) {
      const MembershipLedger restored = RestoredFrom(facts, output);
      EXPECT_EQ(restored.tokens(), ledger_.tokens());
      EXPECT_EQ(restored.members(), ledger_.members());
      EXPECT_EQ(restored.authority(), ledger_.authority());
    }
    EXPECT_TRUE(output.empty());
  }

  std::vector<Fact> facts_;
  MembershipLedger ledger_{facts_};
};

TEST_F(Membership, AJoinThatIsUndoneGivesItsUseBackAndLetsNobodyIn) {
  ASSERT_TRUE(ledger_.IssueToken(Token(1)));
  ASSERT_TRUE(ledger_.Join(kNow, Member(1)));
  ledger_.UndoJoin(MemberId{1});
  ledger_.UndoJoin(MemberId{1});
  ledger_.UndoJoin(MemberId{9});
  EXPECT_TRUE(ledger_.members().at(MemberId{1}).revoked);
  EXPECT_EQ(ledger_.tokens().at(kKey).uses_left, 1u);
  ExpectSameAfterRestart();
  EXPECT_TRUE(ledger_.Join(kNow, Member(2)));
  EXPECT_FALSE(ledger_.Join(kNow, Member(3)));
  ExpectSameAfterRestart();
}

TEST_F(Membership, UndoingAJoinDoesNotRestoreARevokedToken) {
  ASSERT_TRUE(ledger_.IssueToken(Token(2)));
  ASSERT_TRUE(ledger_.Join(kNow, Member(1)));
  ASSERT_TRUE(ledger_.RevokeToken(kKey));
  ledger_.UndoJoin(MemberId{1});
  EXPECT_FALSE(ledger_.Join(kNow, Member(2)));
  ExpectSameAfterRestart();
}

TEST_F(Membership, TheAuthorityIsRecordedWhenItChanges) {
  EXPECT_EQ(ledger_.authority(), std::nullopt);
  for (const char* name : {"first", "first", "second"}) ledger_.ChooseAuthority(Sha256(name));
  EXPECT_EQ(ledger_.authority(), Sha256("second"));
  EXPECT_EQ(facts_.size(), 2u);
  ExpectSameAfterRestart();
}

TEST_F(Membership, ATokenLetsInAsManyAsItSays) {
  ASSERT_TRUE(ledger_.IssueToken(Token(2)));
  EXPECT_TRUE(ledger_.Join(kNow, Member(1)));
  ExpectSameAfterRestart();
  EXPECT_TRUE(ledger_.Join(kNow, Member(2)));
  const auto refused = ledger_.Join(kNow, Member(3));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("used up"));
  EXPECT_EQ(ledger_.members().size(), 2u);
  ExpectSameAfterRestart();
}

TEST_F(Membership, ATokenThatExpiredWasRevokedOrIsUnknownLetsNobodyIn) {
  ASSERT_TRUE(ledger_.IssueToken(Token()));
  EXPECT_THAT(ledger_.Join(kNow + kHour, Member(1)).error().message, HasSubstr("expired"));
  EXPECT_THAT(ledger_.Join(kNow, Member(1, Sha256("other"))).error().message, HasSubstr("does not know"));
  EXPECT_TRUE(ledger_.RevokeToken(kKey));
  EXPECT_FALSE(ledger_.RevokeToken(kKey));
  EXPECT_THAT(ledger_.Join(kNow, Member(1)).error().message, HasSubstr("revoked"));
  EXPECT_TRUE(ledger_.members().empty());
  ExpectSameAfterRestart();
}

TEST_F(Membership, AMemberRenewsUntilItExpiresOrIsRevoked) {
  ASSERT_TRUE(ledger_.IssueToken(Token(2)));
  ASSERT_TRUE(ledger_.Join(kNow, Member(1)));
  ASSERT_TRUE(ledger_.Join(kNow, Member(2)));
  EXPECT_TRUE(ledger_.Renew(kNow + kDay, MemberId{1}, kNow + 91 * kDay));
  EXPECT_EQ(ledger_.members().at(MemberId{1}).expires, kNow + 91 * kDay);
  EXPECT_THAT(ledger_.Renew(kNow + 90 * kDay, MemberId{2}, kNow + 180 * kDay).error().message,
              HasSubstr("expired"));
  EXPECT_TRUE(ledger_.RevokeMember(MemberId{1}));
  EXPECT_FALSE(ledger_.RevokeMember(MemberId{1}));
  EXPECT_THAT(ledger_.Renew(kNow, MemberId{1}, kNow + 91 * kDay).error().message, HasSubstr("revoked"));
  EXPECT_FALSE(ledger_.Renew(kNow, MemberId{3}, kNow + kDay));
  ExpectSameAfterRestart();
}

TEST_F(Membership, TokensAreLimitedAndThoseThatCannotBeUsedMakeRoom) {
  TokenStatus token = Token();
  for (size_t i = 0; i < kTokensMax; ++i) {
    token.key = Sha256(std::to_string(i));
    ASSERT_TRUE(ledger_.IssueToken(token));
  }
  token.key = kKey;
  EXPECT_THAT(ledger_.IssueToken(token).error().message, HasSubstr("limit"));
  EXPECT_TRUE(ledger_.RevokeToken(Sha256("7")));
  EXPECT_TRUE(ledger_.IssueToken(token));
}

TEST_F(Membership, MembersAreLimitedAndThoseThatWereRevokedMakeRoom) {
  ASSERT_TRUE(ledger_.IssueToken(Token(2)));
  for (size_t i = 1; i <= kMembersMax; ++i) ledger_.Restore(MemberJoined{Member(i, Sha256("another token"))});
  EXPECT_THAT(ledger_.Join(kNow, Member(kMembersMax + 1)).error().message,
              HasSubstr("which is its limit; revoke some"));
  EXPECT_EQ(ledger_.tokens().at(kKey).uses_left, 2u) << "the token was not used";
  EXPECT_TRUE(ledger_.RevokeMember(MemberId{7}));
  EXPECT_TRUE(ledger_.Join(kNow, Member(kMembersMax + 1)));
  EXPECT_FALSE(ledger_.Join(kNow, Member(kMembersMax + 2)));
}

TEST_F(Membership, WhatExpiredLongAgoIsForgotten) {
  ASSERT_TRUE(ledger_.IssueToken(Token()));
  ASSERT_TRUE(ledger_.Join(kNow, Member(1)));
  TokenStatus later = Token();
  later.key = Sha256("later");
  later.issued = kNow + 121 * kDay;
  later.expires = later.issued + kHour;
  ASSERT_TRUE(ledger_.IssueToken(later));
  EXPECT_EQ(ledger_.tokens().size(), 1u);
  EXPECT_TRUE(ledger_.members().empty());
}

TEST_F(Membership, HoldersOfCertificatesOfAnOrganisationAreListedOnce) {
  MemberStatus ada = Member(1, {});
  EXPECT_TRUE(ledger_.Enrol(kNow, ada));
  EXPECT_TRUE(ledger_.Enrol(kNow, ada));
  EXPECT_EQ(facts_.size(), 1u);
  ada.expires += 90 * kDay;
  EXPECT_TRUE(ledger_.Enrol(kNow + kDay, ada));
  EXPECT_EQ(facts_.size(), 2u);
  EXPECT_EQ(ledger_.members().at(MemberId{1}).expires, ada.expires);
  ExpectSameAfterRestart();
}

TEST_F(Membership, WhoWasRevokedCannotReturnWithALaterCertificateOfTheOrganisation) {
  ASSERT_TRUE(ledger_.Enrol(kNow, Member(1, {})));
  ASSERT_TRUE(ledger_.Enrol(kNow, Member(2, {})));
  EXPECT_TRUE(ledger_.RevokeMember(MemberId{1}));
  const UnixTime years_later = kNow + 2000 * kDay;
  for (const uint64_t id : {1, 3}) {
    MemberStatus later = Member(id, {});
    later.expires = years_later + kDay;
    EXPECT_TRUE(ledger_.Enrol(years_later, later));
  }
  EXPECT_TRUE(ledger_.members().at(MemberId{1}).revoked);
  EXPECT_FALSE(ledger_.members().contains(MemberId{2}));
}

TEST_F(Membership, TokensWithoutUsesOrTimeAreRefused) {
  EXPECT_FALSE(ledger_.IssueToken(Token(0)));
  EXPECT_FALSE(ledger_.IssueToken(Token(kTokenUsesMax + 1)));
  TokenStatus token = Token();
  token.expires = token.issued;
  EXPECT_FALSE(ledger_.IssueToken(token));
  ASSERT_TRUE(ledger_.IssueToken(Token()));
  EXPECT_FALSE(ledger_.IssueToken(Token()));
}

}  // namespace
}  // namespace tessera
