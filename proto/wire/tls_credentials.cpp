#include "proto/wire/tls_credentials.h"

#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_certificate_verifier.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/rand.h>

#include <cstdlib>
#include <exception>
#include <mutex>
#include <utility>

#include "proto/identity/private_key.h"
#include "proto/identity/server_check.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

using grpc::experimental::FileWatcherCertificateProvider;
using grpc::experimental::StaticDataCertificateProvider;

// Of looks at the files of keys and certificates: two small files.
constexpr unsigned kReloadInterval_s = 10;

class PeerVerifier final : public grpc::experimental::ExternalCertificateVerifier {
 public:
  explicit PeerVerifier(AdmitPeer admit) : admit_(std::move(admit)) {}

  bool Verify(grpc::experimental::TlsCustomVerificationCheckRequest* request,
              std::function<void(grpc::Status)>, grpc::Status* status) override {
    // What a peer sends besides its own certificate may come without that one, so its own always goes first.
    const grpc::string_ref own = request->peer_cert(), sent = request->peer_cert_full_chain();
    *status = Decide(std::string(own.data(), own.size()) + std::string(sent.data(), sent.size()));
    return true;
  }
  void Cancel(grpc::experimental::TlsCustomVerificationCheckRequest*) override {}

 private:
  grpc::Status Decide(std::string_view pem) const {
    try {
      const auto chain = Certificate::ChainFromPem(pem, "the certificate of the peer");
      const Result<void> admitted = chain ? admit_(*chain) : chain.error();
      if (admitted) return grpc::Status::OK;
      return {grpc::StatusCode::UNAUTHENTICATED, admitted.error().message};
    } catch (const std::exception& e) {  // such as std::bad_alloc
      return {grpc::StatusCode::UNAVAILABLE, e.what()};
    }
  }

  const AdmitPeer admit_;
};

// The verifier checks the chain, because OpenSSL would reject a coordinator that shows certificates of an
// organisation.
std::shared_ptr<grpc::ChannelCredentials> ClientCredentials(
    std::shared_ptr<grpc::experimental::CertificateProviderInterface> provider, AdmitPeer admit) {
  PrepareTls();
  grpc::experimental::TlsChannelCredentialsOptions options;
  options.set_certificate_provider(std::move(provider));
  options.watch_identity_key_cert_pairs();
  options.set_verify_server_certs(false);
  options.set_check_call_host(false);
  options.set_certificate_verifier(
      grpc::experimental::ExternalCertificateVerifier::Create<PeerVerifier>(std::move(admit)));
  return grpc::experimental::TlsCredentials(options);
}

Result<void> AdmitIfGood(const ServerVerdict& verdict) {
  if (verdict.IsGood()) return {};
  return Failed("the server is not the expected coordinator");
}

Result<void> AdmitCoordinator(const std::vector<Certificate>& chain, std::string_view authority_pem) {
  const auto authorities = Certificate::ChainFromPem(authority_pem, "authority");
  if (!authorities) return authorities.error();
  return AdmitIfGood(CheckCoordinator(chain, *authorities, UnixNow()));
}

}  // namespace

// OpenSSL has random number generators for each thread and frees them in a destructor of thread-specific
// data, which finds them under another key. The C library calls destructors in the order of the keys and
// clears each value first. A generator whose key precedes that of the destructor is therefore lost, some 7 KB
// for each thread that ends. Embree deletes keys, whose places new ones take, so the keys are created here,
// before it.
void PrepareTls() {
  static std::once_flag once;
  std::call_once(once, [] {
    // gRPC has no setting for the oldest version of TLS. It takes the cipher suites of TLS 1.2 from this
    // variable, and the only one named here needs a shared key that neither end has. TLS 1.3 has its own
    // suites.
    ::setenv("GRPC_SSL_CIPHER_SUITES", "PSK-AES256-GCM-SHA384", 1);
    unsigned char unused = 0;
    static_cast<void>(RAND_bytes(&unused, 1));
  });
}

std::shared_ptr<grpc::ServerCredentials> TlsServerCredentials(const std::string& key_path,
                                                              const std::string& certificate_path,
                                                              AdmitPeer admit) {
  PrepareTls();
  grpc::experimental::TlsServerCredentialsOptions options(
      std::make_shared<FileWatcherCertificateProvider>(key_path, certificate_path, kReloadInterval_s));
  options.watch_identity_key_cert_pairs();
  // The verifier checks the chain: it knows who may be told why a certificate is not accepted.
  options.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_BUT_DONT_VERIFY);
  options.set_check_call_host(false);
  options.set_certificate_verifier(
      grpc::experimental::ExternalCertificateVerifier::Create<PeerVerifier>(std::move(admit)));
  return grpc::experimental::TlsServerCredentials(options);
}

// Files of authorities are read at each handshake: they may have been replaced.
std::shared_ptr<grpc::ChannelCredentials> TlsClientCredentials(const std::string& authority_path,
                                                               const std::string& identity_path) {
  return ClientCredentials(
      std::make_shared<FileWatcherCertificateProvider>(identity_path, identity_path, kReloadInterval_s),
      [authority_path](const std::vector<Certificate>& chain) -> Result<void> {
        const auto pem = ReadFile(authority_path, kPemBytesMax);
        return pem ? AdmitCoordinator(chain, *pem) : Result<void>(pem.error());
      });
}

std::shared_ptr<grpc::ChannelCredentials> TlsClientCredentials(const std::string& authority_pem,
                                                               const std::string& key_pem,
                                                               const std::string& certificate_pem) {
  return ClientCredentials(
      std::make_shared<StaticDataCertificateProvider>(
          "", std::vector<grpc::experimental::IdentityKeyCertPair>{{key_pem, certificate_pem}}),
      [authority_pem](const std::vector<Certificate>& chain) {
        return AdmitCoordinator(chain, authority_pem);
      });
}

std::shared_ptr<grpc::ChannelCredentials> TlsClientCredentials(const TlsFiles& files,
                                                               const std::string& host) {
  return ClientCredentials(
      std::make_shared<FileWatcherCertificateProvider>(files.key, files.certificate, kReloadInterval_s),
      [files, host](const std::vector<Certificate>& chain) -> Result<void> {
        const auto authorities = ReadTlsAuthorities(files);
        if (!authorities) return authorities.error();
        return AdmitIfGood(CheckHost(chain, *authorities, host, UnixNow()));
      });
}

}  // namespace tessera
