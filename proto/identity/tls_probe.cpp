#include "proto/identity/tls_probe.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <poll.h>

#include "proto/identity/openssl_handles.h"
#include "proto/identity/private_key.h"
#include "proto/identity/socket_bio.h"

namespace tessera {
struct TlsProbe::State {
  int socket = -1;
  OpensslOwner<SSL_CTX, SSL_CTX_free> context{SSL_CTX_new(TLS_client_method())};
  OpensslOwner<SSL, SSL_free> ssl;
};

TlsProbe::TlsProbe(int socket, const std::string& identity_pem) : state_(std::make_unique<State>()) {
  state_->socket = socket;
  SSL_CTX* const context = state_->context.get();
  TESSERA_CHECK(context != nullptr);
  SSL_CTX_set_min_proto_version(context, TLS1_3_VERSION);
  SSL_CTX_set_verify(context, SSL_VERIFY_NONE, nullptr);
  const auto key = PrivateKey::FromPem(identity_pem, "identity");
  const auto chain = Certificate::ChainFromPem(identity_pem, "identity");
  if (key && chain) {
    SSL_CTX_use_certificate(context, chain->front().get());
    SSL_CTX_use_PrivateKey(context, key->get());
    for (size_t i = 1; i < chain->size(); ++i) SSL_CTX_add1_chain_cert(context, (*chain)[i].get());
  }
  state_->ssl.reset(SSL_new(context));
  TESSERA_CHECK(state_->ssl != nullptr);
  // HTTP/2 is that of a coordinator; its web page has the other.
  static constexpr unsigned char kProtocols[] = "\2h2\10http/1.1";
  SSL_set_alpn_protos(state_->ssl.get(), kProtocols, sizeof kProtocols - 1);
  BIO* const bio = MakeSocketBio(socket);
  SSL_set_bio(state_->ssl.get(), bio, bio);
}

TlsProbe::~TlsProbe() = default;

Result<void> TlsProbe::AwaitAfter(int result, TimePoint deadline) {
  const int error = SSL_get_error(state_->ssl.get(), result);
  if (error != SSL_ERROR_WANT_READ && error != SSL_ERROR_WANT_WRITE) {
    const char* const reason = ERR_reason_error_string(ERR_peek_last_error());
    return Failed(reason != nullptr ? reason : "the connection was closed");
  }
  pollfd event{state_->socket, static_cast<short>(error == SSL_ERROR_WANT_READ ? POLLIN : POLLOUT), 0};
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
  if (left.count() <= 0 || ::poll(&event, 1, static_cast<int>(left.count())) == 0) return Failed("timed out");
  return {};
}

Result<void> TlsProbe::Handshake(TimePoint deadline) {
  while (true) {
    ERR_clear_error();
    const int result = SSL_connect(state_->ssl.get());
    if (result == 1) return {};
    if (auto waited = AwaitAfter(result, deadline); !waited) return waited;
  }
}

std::vector<Certificate> TlsProbe::PeerChain() const {
  std::vector<Certificate> chain;
  STACK_OF(X509)* const shown = SSL_get_peer_cert_chain(state_->ssl.get());
  for (int i = 0; i < sk_X509_num(shown) && chain.size() < kChainMax; ++i) {
    X509* const each = sk_X509_value(shown, i);
    X509_up_ref(each);
    chain.emplace_back(each);
  }
  return chain;
}

Result<std::string> TlsProbe::Exchange(std::string_view bytes, size_t size_max, TimePoint deadline) {
  // A few bytes fit into one record and into the buffer of the socket.
  while (true) {
    ERR_clear_error();
    const int result = SSL_write(state_->ssl.get(), bytes.data(), static_cast<int>(bytes.size()));
    if (result > 0) break;
    if (auto waited = AwaitAfter(result, deadline); !waited) return waited.error();
  }
  std::string answer(size_max, '\0');
  while (true) {
    ERR_clear_error();
    const int result = SSL_read(state_->ssl.get(), answer.data(), static_cast<int>(answer.size()));
    if (result > 0) {
      answer.resize(static_cast<size_t>(result));
      return answer;
    }
    if (auto waited = AwaitAfter(result, deadline); !waited) return waited.error();
  }
}

}  // namespace tessera
