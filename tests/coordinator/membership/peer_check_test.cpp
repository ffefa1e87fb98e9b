#include "coordinator/membership/peer_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/identity/authority.h"
#include "proto/identity/join_token.h"

namespace tessera {
namespace {

using std::chrono::hours;
using testing::HasSubstr;

constexpr UnixTime kTestNow = 1'800'000'000;

Certificate MemberOf(const Authority& authority, CertificatePurpose purpose = CertificatePurpose::kClient,
                     const std::string& uri = "tessera:worker/0000000000000007") {
  CertificateTerms terms;
  terms.common_name = "blade-7";
  terms.uri = uri;
  terms.purpose = purpose;
  terms.lifetime = hours(24);
  terms.serial = 7;
  return authority.Issue(PrivateKey::Generate(), terms, kTestNow);
}

class PeerCheck : public testing::Test {
 protected:
  Result<void> Check(const Certificate& certificate, UnixTime now = kTestNow) const {
    return CheckPeer({certificate}, authority_.certificate(), organisation_, board_, now);
  }
  const Authority authority_ = Authority::Make("farm", kTestNow);
  std::vector<Certificate> organisation_;
  MemberBoard board_;
};

TEST_F(PeerCheck, AMemberIsAdmittedAndLearnsOnCallsThatItsCertificateHasExpired) {
  const Certificate member = MemberOf(authority_);
  EXPECT_TRUE(Check(member));
  EXPECT_TRUE(Check(member, kTestNow + 48 * 3600));
}

TEST_F(PeerCheck, StrangersAreRefused) {
  EXPECT_THAT(Check(MemberOf(Authority::Make("farm", kTestNow))).error().message,
              HasSubstr("not issued by this farm"));
  EXPECT_THAT(Check(MemberOf(authority_, CertificatePurpose::kServer)).error().message,
              HasSubstr("not that of a member"));
  EXPECT_THAT(Check(MemberOf(authority_), kTestNow - 7200).error().message, HasSubstr("clock"));
  EXPECT_FALSE(CheckPeer({}, authority_.certificate(), {}, board_, kTestNow));
  CertificateTerms nameless;
  nameless.lifetime = hours(1);
  nameless.serial = 3;
  EXPECT_THAT(Check(authority_.Issue(PrivateKey::Generate(), nameless, kTestNow)).error().message,
              HasSubstr("names no member"));
}

TEST_F(PeerCheck, AnOrganisationAndTheFarmVouchForTheirOwnMembersAlone) {
  const Authority others = Authority::Make("organisation", kTestNow);
  const auto make = [](const Authority& authority, const char* uri) {
    return MemberOf(authority, CertificatePurpose::kClient, uri);
  };
  EXPECT_THAT(Check(make(others, "tessera:user/ada")).error().message, HasSubstr("without --tls-ca"));
  organisation_ = {others.certificate()};
  EXPECT_TRUE(Check(make(others, "tessera:user/ada")));
  EXPECT_TRUE(Check(MemberOf(authority_)));
  EXPECT_FALSE(Check(MemberOf(others)));  // with the id of a member of the farm
  EXPECT_FALSE(Check(make(authority_, "tessera:user/ada")));
  EXPECT_FALSE(Check(make(Authority::Make("organisation", kTestNow), "tessera:user/ada")));
  EXPECT_FALSE(Check(make(others, "tessera:king/ada")));
  EXPECT_FALSE(Check(MemberOf(others, CertificatePurpose::kServer, "tessera:user/ada")));
}

TEST_F(PeerCheck, TheHolderOfATokenIsAdmittedOnceTheFarmHasIssuedIt) {
  const JoinToken token = JoinToken::Make("farm:1", authority_.certificate().Fingerprint());
  EXPECT_FALSE(Check(token.MakeCertificate(kTestNow)));
  board_.Note(
      TokenIssued{{token.Key().PublicDigest(), Role::kWorker, "", kTestNow, kTestNow + 60, 1, false}});
  EXPECT_TRUE(Check(token.MakeCertificate(kTestNow)));
  EXPECT_FALSE(Check(JoinToken::Make("farm:1", {}).MakeCertificate(kTestNow)));
}

// With the key of a token, anybody can sign a certificate that states something else.
TEST_F(PeerCheck, ATokenCannotBeMadeIntoAMember) {
  const JoinToken token = JoinToken::Make("farm:1", {}), other = JoinToken::Make("farm:1", {});
  for (const JoinToken& each : {token, other})
    board_.Note(
        TokenIssued{{each.Key().PublicDigest(), Role::kWorker, "", kTestNow, kTestNow + 60, 1, false}});
  CertificateTerms terms;
  terms.lifetime = hours(1);
  terms.serial = 3;
  Subject of_other;
  of_other.token_key = other.Key().PublicDigest();
  for (const std::string& uri : {Subject{Role::kOperator, MemberId{7}, {}}.Uri(), of_other.Uri()}) {
    terms.uri = uri;
    EXPECT_FALSE(Check(MakeSelfSigned(token.Key(), terms, kTestNow))) << uri;
  }
}

}  // namespace
}  // namespace tessera
