#include "proto/wire/tls_credentials.h"

#include <gmock/gmock.h>
#include <grpcpp/channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <netinet/in.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <openssl/ssl.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <thread>

#include "proto/identity/authority.h"
#include "proto/identity/private_file.h"
#include "proto/identity/subject.h"
#include "proto/wire/channel.h"
#include "proto/wire/reachability.h"
#include "proto/work.grpc.pb.h"

namespace tessera {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr milliseconds kPatience{20'000};
constexpr milliseconds kRefusalPatience{1500};

class TlsConnections : public testing::Test {
 protected:
  TlsConnections() {
    folder_ = testing::TempDir() + "tessera-tls-XXXXXX";
    EXPECT_NE(::mkdtemp(folder_.data()), nullptr);
    CertificateTerms terms;
    terms.common_name = "coordinator";
    terms.host_names = {kCoordinatorName};
    terms.purpose = CertificatePurpose::kServer;
    terms.lifetime = hours(1);
    terms.serial = 2;
    const PrivateKey key = PrivateKey::Generate();
    const std::string path = folder_ + "/coordinator.pem";
    EXPECT_TRUE(WritePrivateFile(
        path, key.Pem() + authority_.Issue(key, terms, UnixNow()).Pem() + authority_.certificate().Pem()));
    grpc::ServerBuilder builder;
    ConfigureServer(builder);
    builder.AddListeningPort(
        "127.0.0.1:0", TlsServerCredentials(path, path, [this](const auto& chain) { return Admit(chain); }),
        &port_);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    EXPECT_NE(server_, nullptr);
  }
  ~TlsConnections() override {
    server_->Shutdown(std::chrono::system_clock::now());
    std::filesystem::remove_all(folder_);
  }

  Result<void> Admit(const std::vector<Certificate>& chain) {
    const std::lock_guard lock(mutex_);
    ++asked_;
    const auto verdict =
        CheckCertificate(chain, {authority_.certificate()}, CertificatePurpose::kClient, UnixNow());
    return verdict == CertificateVerdict::kGood ? Result<void>() : Failed("a stranger");
  }
  int asked() {
    const std::lock_guard lock(mutex_);
    return asked_;
  }
  Address address() const {
    Address address;
    address.host = "127.0.0.1";
    address.port = port_;
    return address;
  }
  // A login whose certificate `issuer` made and that trusts `trusted`.
  Login MakeLogin(const Authority& issuer, const Authority& trusted, hours lifetime = hours(1)) {
    CertificateTerms terms;
    terms.common_name = "ada";
    terms.uri = Subject{Role::kUser, MemberId{7}, {}}.Uri();
    terms.lifetime = lifetime;
    terms.serial = 7;
    const PrivateKey key = PrivateKey::Generate();
    return *LoginStore(folder_ + "/farms")
                .Save("studio", address().Text(),
                      {key, issuer.Issue(key, terms, UnixNow()).Pem(), trusted.certificate().Pem()});
  }
  bool Connects(const Login& login, milliseconds patience) {
    return WaitForConnection(*OpenChannel(Endpoint(address(), address(), login)), patience);
  }
  std::string ReasonFor(const Login& login) {
    return CheckReachability(Endpoint(address(), address(), login)).reason;
  }
  // Whether a client that speaks this version at most gets through its part of the handshake.
  bool HandshakeSucceeds(int version_max) const {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_port = htons(static_cast<uint16_t>(port_));
    name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
    SSL_CTX* const context = SSL_CTX_new(TLS_client_method());
    SSL_CTX_set_max_proto_version(context, version_max);
    SSL* const ssl = SSL_new(context);
    SSL_set_fd(ssl, socket);
    const bool done = SSL_connect(ssl) == 1;
    SSL_free(ssl);
    SSL_CTX_free(context);
    ::close(socket);
    return done;
  }

  std::string folder_;
  const Authority authority_ = Authority::Make("farm", UnixNow());
  std::mutex mutex_;
  int asked_ = 0;  // guarded by mutex_
  proto::Work::Service service_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(TlsConnections, AMemberConnects) {
  const Login login = MakeLogin(authority_, authority_);
  EXPECT_TRUE(Connects(login, kPatience));
  EXPECT_EQ(asked(), 1);
  const Reachability found = CheckReachability(Endpoint(address(), address(), login));
  EXPECT_TRUE(found.speaks_http2) << found.reason;
}

TEST_F(TlsConnections, ACertificateOfAnotherAuthorityIsRefused) {
  const Login login = MakeLogin(Authority::Make("farm", UnixNow()), authority_);
  EXPECT_FALSE(Connects(login, kRefusalPatience));
  EXPECT_GT(asked(), 0);
  EXPECT_THAT(ReasonFor(login), HasSubstr("does not accept the certificate of the login \"studio\""));
}

// Whoever has seen the certificate of a member can send it after one of their own.
TEST_F(TlsConnections, TheCertificateOfAMemberDoesNotVouchForAnother) {
  const Login member = MakeLogin(authority_, authority_);
  const std::string genuine = ReadIdentity(member)->Pem();
  const Login forged = MakeLogin(Authority::Make("farm", UnixNow()), authority_);
  const std::string own = *ReadPrivateFile(forged.IdentityPath());
  ASSERT_TRUE(WritePrivateFile(forged.IdentityPath(), own + genuine));
  EXPECT_FALSE(Connects(forged, kRefusalPatience));
  EXPECT_GT(asked(), 0);
}

TEST_F(TlsConnections, ACoordinatorOfAnotherFarmIsNotTrusted) {
  const Login login = MakeLogin(authority_, Authority::Make("farm", UnixNow()));
  EXPECT_FALSE(Connects(login, kRefusalPatience));
  EXPECT_THAT(ReasonFor(login), HasSubstr("is not one of the farm that the login \"studio\" is for"));
}

TEST_F(TlsConnections, AnExpiredCertificateIsNamedAsTheReason) {
  const Login login = MakeLogin(authority_, authority_, hours(0));
  EXPECT_FALSE(Connects(login, kRefusalPatience));
  EXPECT_THAT(ReasonFor(login), HasSubstr("expired on"));
}

TEST_F(TlsConnections, PlainTextIsRefused) {
  EXPECT_FALSE(WaitForConnection(*OpenChannel(address()), kRefusalPatience));
  EXPECT_EQ(asked(), 0);
}

TEST_F(TlsConnections, OlderVersionsOfTlsAreRefused) {
  EXPECT_TRUE(HandshakeSucceeds(TLS1_3_VERSION));
  EXPECT_FALSE(HandshakeSucceeds(TLS1_2_VERSION));
  EXPECT_EQ(asked(), 0);
}

TEST_F(TlsConnections, AnybodyMaySeeTheCertificateOfTheCoordinator) {
  const auto chain = FetchCertificates(address());
  ASSERT_TRUE(chain) << chain.error().message;
  ASSERT_EQ(chain->size(), 2u);
  EXPECT_EQ(chain->back().Fingerprint(), authority_.certificate().Fingerprint());
}

// In a process that has not used OpenSSL yet, deletes a key of thread-specific data that is older than those
// of OpenSSL, as Embree does, and exits with 0 if threads that use OpenSSL afterwards free what they
// allocate.
[[noreturn]] void ReuseAKeyAndExit() {
  constexpr int kThreads = 200;
  constexpr size_t kLeftMax = 100'000;
  ::mallopt(M_ARENA_MAX, 1);  // mallinfo2 counts one arena
  std::array<pthread_key_t, 8> older{};
  for (pthread_key_t& key : older)
    if (::pthread_key_create(&key, nullptr) != 0) std::_Exit(2);
  PrepareTls();
  OPENSSL_init_crypto(OPENSSL_INIT_LOAD_CRYPTO_STRINGS, nullptr);  // creates the key of the destructor
  for (const pthread_key_t key : older) ::pthread_key_delete(key);
  const auto use_openssl = [] {
    unsigned char unused = 0;
    if (RAND_bytes(&unused, 1) != 1 || RAND_priv_bytes(&unused, 1) != 1) std::_Exit(3);
  };
  std::thread(use_openssl).join();
  const size_t before = ::mallinfo2().uordblks;
  for (int i = 0; i < kThreads; ++i) std::thread(use_openssl).join();
  const size_t after = ::mallinfo2().uordblks;
  std::_Exit(after > before + kLeftMax ? 1 : 0);
}

TEST(PreparedTls, ThreadsThatEndFreeTheirRandomNumberGenerators) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(ReuseAKeyAndExit(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace tessera
