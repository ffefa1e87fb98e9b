#include "proto/wire/endpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "proto/identity/authority.h"
#include "proto/wire/local_socket.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class Endpoints : public testing::Test {
 protected:
  Endpoints() {
    folder_ = testing::TempDir() + "tessera-ep-XXXXXX";
    EXPECT_NE(::mkdtemp(folder_.data()), nullptr);
  }
  ~Endpoints() override { std::filesystem::remove_all(folder_); }

  Result<Endpoint> Choose(const std::string& address, bool insecure = false) const {
    return ChooseEndpoint(*ParseAddress(address, "test"),
                          {insecure, Logins(), folder_, "run: tessera login TOKEN"});
  }
  LoginStore Logins() const { return LoginStore(folder_ + "/farms"); }
  void LogIn(const std::string& address, std::chrono::hours lifetime = std::chrono::hours(1)) const {
    const Authority authority = Authority::Make("farm", UnixNow());
    CertificateTerms terms;
    terms.lifetime = lifetime;
    terms.serial = 7;
    const PrivateKey key = PrivateKey::Generate();
    const auto saved =
        Logins().Save("studio", address,
                      {key, authority.Issue(key, terms, UnixNow()).Pem(), authority.certificate().Pem()});
    EXPECT_TRUE(saved) << saved.error().message;
  }

  std::string folder_;
};

TEST_F(Endpoints, AUnixSocketIsUsedAsItIs) {
  const auto endpoint = Choose("unix:/s");
  ASSERT_TRUE(endpoint);
  EXPECT_EQ(endpoint->target.Text(), "unix:/s");
  EXPECT_FALSE(endpoint->login);
  EXPECT_FALSE(endpoint->IsLocalSocket());
}

TEST_F(Endpoints, AnAddressOfThisMachineStandsForTheLocalSocket) {
  for (const char* address : {"127.0.0.1:7700", "localhost:7700"}) {
    const auto endpoint = Choose(address);
    ASSERT_TRUE(endpoint);
    EXPECT_EQ(endpoint->target.Text(), "unix:" + folder_ + "/127.0.0.1-7700.socket");
    EXPECT_EQ(endpoint->address.Text(), address);
    EXPECT_TRUE(endpoint->IsLocalSocket());
  }
}

TEST_F(Endpoints, ALoginComesBeforeTheLocalSocket) {
  LogIn("127.0.0.1:7700");
  const auto endpoint = Choose("127.0.0.1:7700");
  ASSERT_TRUE(endpoint);
  ASSERT_TRUE(endpoint->login);
  EXPECT_EQ(endpoint->login->farm, "studio");
  EXPECT_EQ(endpoint->target.Text(), "127.0.0.1:7700");
}

TEST_F(Endpoints, ALoginThatCannotBeUsedIsRefusedWithTheRemedy) {
  LogIn("10.0.0.5:7700");
  const std::string path = Logins().Default()->IdentityPath();
  ASSERT_EQ(::chmod(path.c_str(), 0644), 0);
  EXPECT_THAT(Choose("10.0.0.5:7700").error().message, HasSubstr("chmod 600"));
  LogIn("10.0.0.5:7700", std::chrono::hours(0));
  EXPECT_THAT(Choose("10.0.0.5:7700").error().message, HasSubstr("expired on"));
}

TEST_F(Endpoints, AnAddressWithoutALoginIsRefusedWithTheRemedy) {
  LogIn("10.0.0.6:7700");
  const auto endpoint = Choose("10.0.0.5:7700");
  ASSERT_FALSE(endpoint);
  EXPECT_THAT(endpoint.error().message, HasSubstr("tessera login TOKEN"));
  std::ofstream(folder_ + "/10.0.0.5-7700.socket") << "";
  EXPECT_TRUE(Choose("10.0.0.5:7700")) << "a coordinator of this user listens there";
}

TEST_F(Endpoints, TheLocalSocketGoesBeforeALoginWhereItIsPreferred) {
  LogIn("127.0.0.1:7700");
  const Address address = *ParseAddress("127.0.0.1:7700", "test");
  EndpointRules rules{false, Logins(), folder_, "run: tessera login TOKEN"};
  rules.prefer_local_socket = true;
  EXPECT_TRUE(ChooseEndpoint(address, rules)->login) << "nobody listens on the socket";
  const Address socket = *LocalSocketOf(address, folder_);
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::memcpy(name.sun_path, socket.path.c_str(), socket.path.size() + 1);
  const int listener = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(::bind(listener, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  ASSERT_EQ(::listen(listener, 1), 0);
  EXPECT_TRUE(ChooseEndpoint(address, rules)->IsLocalSocket());
  EXPECT_TRUE(Choose("127.0.0.1:7700")->login) << "everybody else uses the login";
  ::close(listener);
  EXPECT_TRUE(ChooseEndpoint(address, rules)->login) << "its coordinator was killed";
}

TEST_F(Endpoints, PlainTextIsForThisMachineAlone) {
  LogIn("127.0.0.1:7700");
  const auto plain = Choose("127.0.0.1:7700", true);
  ASSERT_TRUE(plain);
  EXPECT_FALSE(plain->login);
  EXPECT_EQ(plain->target.Text(), "127.0.0.1:7700");
  EXPECT_THAT(Choose("10.0.0.5:7700", true).error().message, HasSubstr("--insecure"));
}

TEST(LocalSockets, AWildcardHasTheSocketOfTheLoopbackAddress) {
  const auto socket = LocalSocketOf(*ParseAddress("0.0.0.0:7700", "test"), "/run/user/1/tessera");
  ASSERT_TRUE(socket);
  EXPECT_EQ(socket->path, "/run/user/1/tessera/127.0.0.1-7700.socket");
  EXPECT_EQ(LocalSocketOf(*ParseAddress("[::1]:7700", "test"), "/run")->path, "/run/__1-7700.socket");
  EXPECT_FALSE(LocalSocketOf(*ParseAddress("unix:/s", "test"), "/run"));
  EXPECT_FALSE(LocalSocketOf(*ParseAddress("127.0.0.1:1", "test"), std::string(120, 'x')));
}

}  // namespace
}  // namespace tessera
