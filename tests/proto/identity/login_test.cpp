#include "proto/identity/login.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <map>

#include "proto/identity/authority.h"
#include "proto/identity/private_file.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class Logins : public testing::Test {
 protected:
  Logins() {
    folder_ = testing::TempDir() + "tessera-logins-XXXXXX";
    EXPECT_NE(::mkdtemp(folder_.data()), nullptr);
  }
  ~Logins() override { std::filesystem::remove_all(folder_); }

  LoginStore Store() const { return LoginStore(folder_ + "/a/farms"); }
  static IssuedIdentity MakeIdentity() {
    const Authority authority = Authority::Make("farm", UnixNow());
    const PrivateKey key = PrivateKey::Generate();
    CertificateTerms terms;
    terms.common_name = "ada";
    terms.lifetime = std::chrono::hours(1);
    terms.serial = 7;
    return {key, authority.Issue(key, terms, UnixNow()).Pem(), authority.certificate().Pem()};
  }
  static unsigned ModeOf(const std::string& path) {
    struct stat status {};
    EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
    return status.st_mode & 07777;
  }

  std::string folder_;
};

TEST_F(Logins, AreFoundByNameByAddressAndAsTheDefault) {
  const LoginStore store = Store();
  EXPECT_FALSE(store.Default());
  EXPECT_TRUE(store.List().empty());
  ASSERT_TRUE(store.Save("studio", "10.0.0.5:7700", MakeIdentity()));
  ASSERT_TRUE(store.Save("home", "farm.example:7700", MakeIdentity()));
  EXPECT_EQ(store.Default()->farm, "home");
  EXPECT_EQ(store.Find("studio")->address, "10.0.0.5:7700");
  EXPECT_EQ(store.FindAddress("10.0.0.5:7700")->farm, "studio");
  EXPECT_FALSE(store.FindAddress("10.0.0.6:7700"));
  EXPECT_FALSE(store.Find("../studio"));
  ASSERT_EQ(store.List().size(), 2u);
  EXPECT_EQ(store.List().front().farm, "home");
}

TEST_F(Logins, TheDefaultWinsAmongLoginsWithOneAddress) {
  ASSERT_TRUE(Store().Save("b", "farm:1", MakeIdentity()));
  ASSERT_TRUE(Store().Save("a", "farm:1", MakeIdentity()));
  EXPECT_EQ(Store().FindAddress("farm:1")->farm, "a");
  ASSERT_TRUE(Store().Save("b", "farm:1", MakeIdentity()));
  EXPECT_EQ(Store().FindAddress("farm:1")->farm, "b");
}

TEST_F(Logins, OnlyTheirUserCanReadThem) {
  ::umask(0);
  const auto login = Store().Save("studio", "farm:1", MakeIdentity());
  ::umask(022);
  ASSERT_TRUE(login) << login.error().message;
  EXPECT_EQ(ModeOf(login->folder), 0700u);
  EXPECT_EQ(ModeOf(login->IdentityPath()), 0600u);
  const auto certificate = ReadIdentity(*login);
  ASSERT_TRUE(certificate) << certificate.error().message;
  EXPECT_EQ(certificate->CommonName(), "ada");
}

TEST_F(Logins, AKeyThatOthersCanReadIsRefusedWithTheRemedy) {
  const auto login = Store().Save("studio", "farm:1", MakeIdentity());
  ASSERT_TRUE(login);
  ASSERT_EQ(::chmod(login->IdentityPath().c_str(), 0644), 0);
  const auto refused = ReadIdentity(*login);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("chmod 600 " + login->IdentityPath()));
}

TEST_F(Logins, AKeyOfAnotherCertificateIsRefused) {
  const auto login = Store().Save("studio", "farm:1", MakeIdentity());
  ASSERT_TRUE(login);
  ASSERT_TRUE(
      WritePrivateFile(login->IdentityPath(), PrivateKey::Generate().Pem() + MakeIdentity().certificate_pem));
  EXPECT_THAT(ReadIdentity(*login).error().message, HasSubstr("does not belong"));
}

TEST_F(Logins, ThatAreRemovedLeaveNoKeyAndNoDefault) {
  ASSERT_TRUE(Store().Save("home", "farm:1", MakeIdentity()));
  const auto login = Store().Save("studio", "farm:2", MakeIdentity());
  ASSERT_TRUE(login);
  ASSERT_TRUE(Store().Remove(*login));
  EXPECT_FALSE(std::filesystem::exists(login->folder));
  EXPECT_FALSE(Store().Find("studio"));
  EXPECT_FALSE(Store().Default());
  EXPECT_TRUE(Store().Find("home"));
  ASSERT_TRUE(Store().Save("studio", "farm:2", MakeIdentity()));
  ASSERT_TRUE(Store().Remove(*Store().Find("home")));
  EXPECT_EQ(Store().Default()->farm, "studio");
}

TEST_F(Logins, ThatAreRemovedLeaveOtherFilesOfTheirFolder) {
  const auto login = Store().Save("studio", "farm:1", MakeIdentity());
  ASSERT_TRUE(login);
  ASSERT_TRUE(WritePrivateFile(login->folder + "/notes", "mine"));
  ASSERT_TRUE(Store().Remove(*login));
  EXPECT_FALSE(std::filesystem::exists(login->IdentityPath()));
  EXPECT_TRUE(std::filesystem::exists(login->folder + "/notes"));
}

TEST_F(Logins, AKeyThatCannotBeDeletedIsAnError) {
  const auto login = Store().Save("studio", "farm:1", MakeIdentity());
  ASSERT_TRUE(login);
  std::filesystem::remove(login->IdentityPath());
  std::filesystem::create_directory(login->IdentityPath());
  const auto removed = Store().Remove(*login);
  ASSERT_FALSE(removed);
  EXPECT_THAT(removed.error().message, HasSubstr("cannot delete " + login->IdentityPath()));
}

TEST_F(Logins, NamesOfFarmsCannotLeaveTheFolder) {
  for (const char* name : {"", ".", "..", "a/b", ".hidden", "a b"}) {
    EXPECT_FALSE(IsFarmName(name)) << name;
    EXPECT_FALSE(Store().Save(name, "farm:1", MakeIdentity())) << name;
  }
  EXPECT_FALSE(IsFarmName(std::string(65, 'a')));
  EXPECT_TRUE(IsFarmName("studio-2.example"));
}

TEST_F(Logins, AnAddressCanNameAFarm) {
  EXPECT_EQ(FarmNameFor("10.0.0.5:7700"), "10.0.0.5-7700");
  EXPECT_EQ(FarmNameFor("[fe80::1]:7700"), "fe80--1--7700");
  EXPECT_EQ(FarmNameFor(std::string(300, 'a') + ":1"), "farm");
}

TEST_F(Logins, AFolderThatIsALinkIsRefused) {
  std::filesystem::create_directory(folder_ + "/target");
  std::filesystem::create_symlink(folder_ + "/target", folder_ + "/link");
  const auto refused = PreparePrivateFolder(folder_ + "/link");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("is a link"));
}

TEST(LoginFolders, FollowTheEnvironment) {
  std::map<std::string, std::string> set{{"HOME", "/home/ada"}};
  const auto read = [&](const char* variable) { return set[variable]; };
  EXPECT_EQ(PersonalLoginFolder(read), "/home/ada/.config/tessera/farms");
  EXPECT_EQ(WorkerLoginFolder(read), "/home/ada/.local/state/tessera/worker/farms");
  set["XDG_CONFIG_HOME"] = "/c";
  set["XDG_STATE_HOME"] = "/s";
  EXPECT_EQ(PersonalLoginFolder(read), "/c/tessera/farms");
  EXPECT_EQ(WorkerLoginFolder(read), "/s/tessera/worker/farms");
  set["STATE_DIRECTORY"] = "/var/lib/tessera:/other";
  EXPECT_EQ(WorkerLoginFolder(read), "/var/lib/tessera/farms");
}

}  // namespace
}  // namespace tessera
