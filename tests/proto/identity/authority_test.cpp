#include "proto/identity/authority.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "proto/identity/subject.h"

namespace tessera {
namespace {

using std::chrono::hours;
using testing::HasSubstr;

constexpr UnixTime kNow = 1'800'000'000;

CertificateTerms WorkerTerms() {
  CertificateTerms terms;
  terms.common_name = "blade-7";
  terms.uri = "tessera:worker/00000000000000ab";
  terms.lifetime = hours(24);
  terms.serial = 0xab;
  return terms;
}

CertificateVerdict Check(const Certificate& certificate, const Authority& authority, UnixTime now = kNow,
                         CertificatePurpose purpose = CertificatePurpose::kClient) {
  return CheckCertificate({certificate}, {authority.certificate()}, purpose, now);
}

TEST(Authority, SignsTheKeyOfARequestUnderItsOwnTerms) {
  const Authority authority = Authority::Make("farm", kNow);
  const PrivateKey key = PrivateKey::Generate();
  const auto signed_key = authority.Sign(MakeSigningRequest(key), WorkerTerms(), kNow);
  ASSERT_TRUE(signed_key) << signed_key.error().message;
  EXPECT_EQ(signed_key->KeyDigest(), key.PublicDigest());
  EXPECT_EQ(signed_key->CommonName(), "blade-7");
  EXPECT_EQ(signed_key->Uri(), WorkerTerms().uri);
  EXPECT_EQ(signed_key->NotAfter(), kNow + 24 * 3600);
  EXPECT_EQ(signed_key->NotBefore(), kNow - 3600);
  EXPECT_EQ(Check(*signed_key, authority), CertificateVerdict::kGood);
}

TEST(Authority, StaysTheSameThroughItsPemForm) {
  const Authority authority = Authority::Make("farm", kNow);
  const auto read = Authority::FromPem(authority.Pem(), "authority.pem");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->certificate().Fingerprint(), authority.certificate().Fingerprint());
  const auto made = read->Sign(MakeSigningRequest(PrivateKey::Generate()), WorkerTerms(), kNow);
  ASSERT_TRUE(made);
  EXPECT_EQ(Check(*made, authority), CertificateVerdict::kGood);
}

TEST(Authority, ACertificateIsGoodOnlyForItsTimeItsPurposeAndItsFarm) {
  const Authority authority = Authority::Make("farm", kNow), other = Authority::Make("farm", kNow);
  const auto made = authority.Sign(MakeSigningRequest(PrivateKey::Generate()), WorkerTerms(), kNow);
  ASSERT_TRUE(made);
  EXPECT_EQ(Check(*made, authority, kNow + 25 * 3600), CertificateVerdict::kExpired);
  EXPECT_EQ(Check(*made, authority, kNow - 2 * 3600), CertificateVerdict::kNotYetValid);
  EXPECT_EQ(Check(*made, other), CertificateVerdict::kNotIssuedHere);
  EXPECT_EQ(Check(*made, authority, kNow, CertificatePurpose::kServer), CertificateVerdict::kWrongPurpose);
}

TEST(Authority, AMemberCannotIssueCertificates) {
  const Authority authority = Authority::Make("farm", kNow);
  const PrivateKey key = PrivateKey::Generate();
  const Certificate member = authority.Issue(key, WorkerTerms(), kNow);
  const auto member_as_authority = Authority::FromPem(key.Pem() + member.Pem(), "member");
  ASSERT_TRUE(member_as_authority);
  const Certificate forged = member_as_authority->Issue(PrivateKey::Generate(), WorkerTerms(), kNow);
  EXPECT_EQ(CheckCertificate({forged, member}, {authority.certificate()}, CertificatePurpose::kClient, kNow),
            CertificateVerdict::kNotIssuedHere);
}

TEST(Authority, NamesTheHostsOfACoordinator) {
  const Authority authority = Authority::Make("farm", kNow);
  CertificateTerms terms = WorkerTerms();
  terms.purpose = CertificatePurpose::kServer;
  terms.host_names = {"farm.example", "10.1.2.3", "fe80::1", "odd,name"};
  const Certificate made = authority.Issue(PrivateKey::Generate(), terms, kNow);
  EXPECT_EQ(made.HostNames(), terms.host_names);
  EXPECT_EQ(Check(made, authority, kNow, CertificatePurpose::kServer), CertificateVerdict::kGood);
}

TEST(Authority, RefusesRequestsThatAreDamagedOrTooLarge) {
  const Authority authority = Authority::Make("farm", kNow);
  std::string request = MakeSigningRequest(PrivateKey::Generate());
  EXPECT_FALSE(authority.Sign("", WorkerTerms(), kNow));
  EXPECT_FALSE(authority.Sign(request.substr(0, request.size() / 2), WorkerTerms(), kNow));
  const auto too_large = authority.Sign(request + std::string(5000, '\n'), WorkerTerms(), kNow);
  ASSERT_FALSE(too_large);
  EXPECT_THAT(too_large.error().message, HasSubstr("too large"));
  // A digit of the signature, near the end.
  request[request.size() - 40] = request[request.size() - 40] == 'A' ? 'B' : 'A';
  EXPECT_FALSE(authority.Sign(request, WorkerTerms(), kNow));
}

TEST(Authority, RefusesKeysOfOtherKinds) {
  const Authority authority = Authority::Make("farm", kNow);
  EVP_PKEY* const key = EVP_EC_gen("P-384");
  X509_REQ* const request = X509_REQ_new();
  X509_REQ_set_pubkey(request, key);
  X509_REQ_sign(request, key, EVP_sha256());
  BIO* const bio = BIO_new(BIO_s_mem());
  PEM_write_bio_X509_REQ(bio, request);
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(bio, &bytes);
  const auto refused = authority.Sign({bytes, static_cast<size_t>(size)}, WorkerTerms(), kNow);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("P-256"));
  BIO_free(bio);
  X509_REQ_free(request);
  EVP_PKEY_free(key);
}

TEST(Certificate, FilesAreReadWithinLimits) {
  const Authority authority = Authority::Make("farm", kNow);
  const std::string pem = authority.certificate().Pem();
  EXPECT_THAT(Certificate::FromPem("", "a.pem").error().message, HasSubstr("a.pem: holds no certificate"));
  EXPECT_FALSE(Certificate::FromPem(std::string(100'000, 'x'), "a.pem"));
  std::string many;
  for (size_t i = 0; i <= kChainMax; ++i) many += pem;
  EXPECT_THAT(Certificate::ChainFromPem(many, "a.pem").error().message,
              HasSubstr("more than 16 certificates"));
  EXPECT_FALSE(PrivateKey::FromPem(pem, "a.pem"));
  const auto mixed = Authority::FromPem(PrivateKey::Generate().Pem() + pem, "a.pem");
  ASSERT_FALSE(mixed);
  EXPECT_THAT(mixed.error().message, HasSubstr("does not belong"));
}

TEST(Subject, IsReadBackFromItsUri) {
  for (const auto& [role, name] : kRoleNames) {
    const Subject member{role, MemberId{0x12ab}, {}};
    EXPECT_EQ(Subject::Parse(member.Uri()), member) << name;
  }
  Subject holder;
  holder.token_key = Sha256("key");
  EXPECT_EQ(Subject::Parse(holder.Uri()), holder);
}

TEST(Subject, CertificatesOfAnOrganisationNameTheirHolder) {
  const auto ada = Subject::Parse("tessera:user/ada.l@example-1");
  ASSERT_TRUE(ada);
  EXPECT_TRUE(ada->IsMember());
  EXPECT_TRUE(ada->IsOfOrganisation());
  EXPECT_EQ(ada->name, "ada.l@example-1");
  EXPECT_EQ(ada->Uri(), "tessera:user/ada.l@example-1");
  EXPECT_NE(ada->id, MemberId{});
  EXPECT_EQ(Subject::Parse(ada->Uri()), ada);
  EXPECT_NE(Subject::Parse("tessera:operator/ada.l@example-1")->id, ada->id);
  EXPECT_FALSE(Subject::Parse("tessera:user/00000000000000ab")->IsOfOrganisation());
  EXPECT_FALSE(Subject::Parse("tessera:user/" + std::string(65, 'a')));
}

TEST(Subject, OtherUrisStandForNobody) {
  for (const char* uri :
       {"", "tessera:", "tessera:worker", "tessera:worker/", "tessera:king/ada",
        "tessera:king/00000000000000ab", "tessera:worker/0000000000000000", "tessera:token/00ab",
        "spiffe:worker/00000000000000ab", "tessera:user/a da", "tessera:user/a/b", "tessera:user/%41da",
        "tessera:user/ada\n", "tessera:worker/+0000000000000ab", "tessera:worker/00000000000000ab/"}) {
    EXPECT_EQ(Subject::Parse(uri), std::nullopt) << uri;
  }
}

}  // namespace
}  // namespace tessera
