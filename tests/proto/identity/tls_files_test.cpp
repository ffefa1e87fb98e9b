#include "proto/identity/tls_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "proto/identity/authority.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

using std::chrono::hours;
using testing::HasSubstr;

constexpr UnixTime kFilesTime = 1'800'000'000;

class FilesOfAnOrganisation : public testing::Test {
 protected:
  FilesOfAnOrganisation() {
    folder_ = testing::TempDir() + "tessera-tls-files-XXXXXX";
    EXPECT_NE(::mkdtemp(folder_.data()), nullptr);
    files_ = {folder_ + "/server.pem", folder_ + "/server.key", folder_ + "/ca.pem"};
    Put(files_.key, key_.Pem(), 0600);
    Put(files_.certificate, Issue(key_, CertificatePurpose::kServer).Pem(), 0644);
    Put(files_.authority, authority_.certificate().Pem(), 0644);
  }
  ~FilesOfAnOrganisation() override { std::filesystem::remove_all(folder_); }

  static void Put(const std::string& path, const std::string& text, mode_t mode) {
    EXPECT_TRUE(WriteFileAtomically(path, text));
    EXPECT_EQ(::chmod(path.c_str(), mode), 0);
  }
  Certificate Issue(const PrivateKey& key, CertificatePurpose purpose) const {
    CertificateTerms terms;
    terms.common_name = "server";
    terms.host_names = {"farm.example"};
    terms.purpose = purpose;
    terms.lifetime = hours(1);
    terms.serial = 5;
    return authority_.Issue(key, terms, kFilesTime);
  }
  std::string WhyNot(UnixTime now = kFilesTime) const {
    const auto read = ReadTlsIdentity(files_, CertificatePurpose::kServer, now);
    return read ? "" : read.error().message;
  }

  std::string folder_;
  const Authority authority_ = Authority::Make("organisation", kFilesTime);
  const PrivateKey key_ = PrivateKey::Generate();
  TlsFiles files_;
};

TEST_F(FilesOfAnOrganisation, KeyAndCertificateAreReadIfTheyBelongTogether) {
  EXPECT_EQ(WhyNot(), "");
  EXPECT_TRUE(ReadTlsAuthorities(files_));
  Put(files_.key, PrivateKey::Generate().Pem(), 0600);
  EXPECT_THAT(WhyNot(), HasSubstr("server.pem: the first certificate does not belong to the key in"));
}

TEST_F(FilesOfAnOrganisation, AKeyMayBeReadByItsGroupButNotByEverybody) {
  for (const mode_t good : {0600, 0400, 0640, 0440}) {
    ASSERT_EQ(::chmod(files_.key.c_str(), good), 0);
    EXPECT_EQ(WhyNot(), "") << std::oct << good;
  }
  for (const mode_t bad : {0644, 0604, 0660, 0602, 0777}) {
    ASSERT_EQ(::chmod(files_.key.c_str(), bad), 0);
    EXPECT_THAT(WhyNot(), HasSubstr("server.key: everybody may read this key")) << std::oct << bad;
    EXPECT_THAT(WhyNot(), HasSubstr("chmod 640"));
  }
}

TEST_F(FilesOfAnOrganisation, TimesAndPurposesThatDoNotFitAreNamed) {
  EXPECT_THAT(WhyNot(kFilesTime + 7200), HasSubstr("server.pem: the certificate is valid from"));
  EXPECT_THAT(WhyNot(kFilesTime - 7200), HasSubstr("not now"));
  Put(files_.certificate, Issue(key_, CertificatePurpose::kClient).Pem(), 0644);
  EXPECT_THAT(WhyNot(), HasSubstr("cannot be used by a TLS server"));
}

TEST_F(FilesOfAnOrganisation, ManyAuthoritiesAreAccepted) {
  const std::string one = authority_.certificate().Pem();
  std::string many;
  for (int i = 0; i < 200; ++i) many += one;
  Put(files_.authority, many, 0644);
  ASSERT_TRUE(ReadTlsAuthorities(files_));
  EXPECT_EQ(ReadTlsAuthorities(files_)->size(), 200u);
  Put(files_.authority, std::string(5 << 20, 'x'), 0644);
  EXPECT_FALSE(ReadTlsAuthorities(files_));
}

TEST_F(FilesOfAnOrganisation, FilesThatAreMissingOrDamagedAreNamed) {
  for (const std::string& path : {files_.key, files_.certificate}) {
    const std::string bytes = *ReadFile(path, 1 << 16);
    std::filesystem::remove(path);
    EXPECT_THAT(WhyNot(), HasSubstr(path));
    Put(path, "no PEM", 0600);
    EXPECT_THAT(WhyNot(), HasSubstr(path + ": holds no"));
    Put(path, bytes, 0600);
  }
  Put(files_.authority, "", 0644);
  EXPECT_THAT(ReadTlsAuthorities(files_).error().message, HasSubstr("ca.pem: holds no certificate"));
}

}  // namespace
}  // namespace tessera
