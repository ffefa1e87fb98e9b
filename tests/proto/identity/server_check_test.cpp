#include "proto/identity/server_check.h"

#include <gtest/gtest.h>

#include "proto/identity/authority.h"
#include "proto/identity/subject.h"

namespace tessera {
namespace {

constexpr UnixTime kCheckTime = 1'800'000'000;

class ServerChecks : public testing::Test {
 protected:
  static Certificate Issue(const Authority& authority, const PrivateKey& key, std::vector<std::string> names,
                           std::chrono::hours lifetime = std::chrono::hours(1)) {
    CertificateTerms terms;
    terms.common_name = "server";
    terms.host_names = std::move(names);
    terms.purpose = CertificatePurpose::kServer;
    terms.lifetime = lifetime;
    terms.serial = 3;
    return authority.Issue(key, terms, kCheckTime);
  }
  bool IsCoordinator(const std::vector<Certificate>& chain, UnixTime now = kCheckTime) const {
    return CheckCoordinator(chain, {farm_.certificate()}, now).IsGood();
  }

  const Authority farm_ = Authority::Make("farm", kCheckTime);
  const Authority organisation_ = Authority::Make("organisation", kCheckTime);
  const PrivateKey key_ = PrivateKey::Generate();
  const Certificate of_farm_ = Issue(farm_, key_, {kCoordinatorName});
  const Certificate of_organisation_ =
      Issue(organisation_, key_, {"farm.example", "*.render.example", "10.1.2.3"});
};

TEST_F(ServerChecks, TheFarmVouchesForTheKeyWhicheverCertificateComesFirst) {
  EXPECT_TRUE(IsCoordinator({of_farm_, farm_.certificate()}));
  EXPECT_TRUE(IsCoordinator({of_organisation_, organisation_.certificate(), of_farm_, farm_.certificate()}));
}

TEST_F(ServerChecks, TheCertificateOfACoordinatorDoesNotVouchForAnotherKey) {
  const Certificate impostor = Issue(organisation_, PrivateKey::Generate(), {kCoordinatorName});
  EXPECT_FALSE(IsCoordinator({impostor, of_farm_, farm_.certificate()}));
  EXPECT_FALSE(IsCoordinator({impostor}));
  EXPECT_FALSE(IsCoordinator({of_organisation_}));
  EXPECT_FALSE(IsCoordinator({}));
}

TEST_F(ServerChecks, OtherCertificatesOfTheFarmDoNotMakeACoordinator) {
  EXPECT_FALSE(IsCoordinator({Issue(farm_, key_, {"farm.example"})}));
  CertificateTerms member;
  member.common_name = "blade";
  member.host_names = {kCoordinatorName};
  member.lifetime = std::chrono::hours(1);
  member.serial = 4;
  EXPECT_FALSE(IsCoordinator({farm_.Issue(key_, member, kCheckTime)}));
}

TEST_F(ServerChecks, AnExpiredCertificateIsNamed) {
  const UnixTime late = kCheckTime + 7200;
  const ServerVerdict found = CheckCoordinator({of_organisation_, of_farm_}, {farm_.certificate()}, late);
  EXPECT_EQ(found.verdict, CertificateVerdict::kExpired);
  ASSERT_TRUE(found.certificate);
  EXPECT_EQ(found.certificate->Fingerprint(), of_farm_.Fingerprint());
}

TEST_F(ServerChecks, ACertificateOfAnOrganisationIsForItsHostsAlone) {
  const auto is_for = [&](const char* host) {
    return CheckHost({of_organisation_}, {organisation_.certificate()}, host, kCheckTime).IsGood();
  };
  for (const char* host : {"farm.example", "FARM.example", "a.render.example", "10.1.2.3"})
    EXPECT_TRUE(is_for(host)) << host;
  for (const char* host :
       {"example", "a.farm.example", "render.example", "a.b.render.example", "10.1.2.4", "", "server"})
    EXPECT_FALSE(is_for(host)) << host;
  EXPECT_FALSE(CheckHost({of_organisation_}, {farm_.certificate()}, "farm.example", kCheckTime).IsGood());
  EXPECT_FALSE(CheckHost({}, {organisation_.certificate()}, "farm.example", kCheckTime).IsGood());
}

}  // namespace
}  // namespace tessera
