#include "coordinator/membership/farm_identity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "proto/identity/private_file.h"
#include "proto/identity/subject.h"
#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr UnixTime kNow = 1'800'000'000;
constexpr UnixTime kYear = 365 * 24 * 3600;

class FarmIdentityFiles : public testing::Test {
 protected:
  Result<FarmIdentity> Open(std::vector<std::string> names = {"farm.example"}, UnixTime now = kNow) {
    return FarmIdentity::Open(folder_ / "identity", std::move(names), now);
  }
  static Certificate CertificateOf(const FarmIdentity& identity) {
    return *Certificate::FromPem(*ReadPrivateFile(identity.coordinator_path()), "coordinator.pem");
  }
  TemporaryDir folder_;
};

TEST_F(FarmIdentityFiles, TheFirstStartMakesAnAuthorityAndACertificateForAllNames) {
  const auto identity = Open({"farm.example", "10.1.2.3"});
  ASSERT_TRUE(identity) << identity.error().message;
  EXPECT_TRUE(identity->is_new());
  const Certificate made = CertificateOf(*identity);
  for (const char* name : {"farm.example", "10.1.2.3", "localhost", "127.0.0.1", kCoordinatorName})
    EXPECT_THAT(made.HostNames(), Contains(name));
  EXPECT_EQ(
      CheckCertificate({made}, {identity->authority().certificate()}, CertificatePurpose::kServer, kNow),
      CertificateVerdict::kGood);
}

TEST_F(FarmIdentityFiles, LaterStartsKeepBoth) {
  const auto first = Open();
  ASSERT_TRUE(first);
  const Digest coordinator = CertificateOf(*first).Fingerprint();
  const auto second = Open();
  ASSERT_TRUE(second);
  EXPECT_FALSE(second->is_new());
  EXPECT_EQ(second->authority().certificate().Fingerprint(), first->authority().certificate().Fingerprint());
  EXPECT_EQ(CertificateOf(*second).Fingerprint(), coordinator);
}

TEST_F(FarmIdentityFiles, OtherNamesAndHalfALifeBringANewCertificateOfTheSameAuthority) {
  const auto first = Open();
  ASSERT_TRUE(first);
  const Digest authority = first->authority().certificate().Fingerprint();
  Digest last = CertificateOf(*first).Fingerprint();
  for (const auto& [name, time] :
       {std::pair("other.example", kNow), {"other.example", kNow + kYear * 2 / 3}}) {
    const auto next = Open({name}, time);
    ASSERT_TRUE(next);
    EXPECT_NE(CertificateOf(*next).Fingerprint(), last);
    EXPECT_EQ(next->authority().certificate().Fingerprint(), authority);
    last = CertificateOf(*next).Fingerprint();
  }
}

TEST_F(FarmIdentityFiles, AnAuthorityThatHasExpiredIsNamedWithTheRemedy) {
  ASSERT_TRUE(Open());
  const auto late = Open({}, kNow + 11 * kYear);
  ASSERT_FALSE(late);
  EXPECT_THAT(late.error().message, HasSubstr("authority.pem: expired on"));
}

TEST_F(FarmIdentityFiles, AKeyThatOthersCanReadIsRefused) {
  ASSERT_TRUE(Open());
  const std::string path = folder_ / "identity/authority.pem";
  ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
  EXPECT_THAT(Open().error().message, HasSubstr("chmod 600"));
}

TEST_F(FarmIdentityFiles, ADamagedAuthorityIsNotReplaced) {
  ASSERT_TRUE(Open());
  const std::string path = folder_ / "identity/authority.pem";
  ASSERT_TRUE(WritePrivateFile(path, "damaged"));
  EXPECT_THAT(Open().error().message, HasSubstr("authority.pem"));
  EXPECT_EQ(*ReadPrivateFile(path), "damaged");
}

}  // namespace
}  // namespace tessera
