#include "proto/identity/tls_server.h"

#include <openssl/err.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <exception>

#include "proto/identity/openssl_handles.h"
#include "proto/identity/private_key.h"
#include "proto/identity/socket_bio.h"

namespace tessera {
namespace {

constexpr long kClientChainBytesMax = 32 << 10;  // ours have less than 2 KiB
constexpr unsigned char kProtocol[] = "\x08http/1.1";

int SelectProtocol(SSL*, const unsigned char** chosen, unsigned char* chosen_size,
                   const unsigned char* offered, unsigned offered_size, void*) {
  unsigned char* found = nullptr;
  if (SSL_select_next_proto(&found, chosen_size, kProtocol, sizeof kProtocol - 1, offered, offered_size) !=
      OPENSSL_NPN_NEGOTIATED)
    return SSL_TLSEXT_ERR_ALERT_FATAL;
  *chosen = found;
  return SSL_TLSEXT_ERR_OK;
}

Certificate Shared(X509* certificate) {
  X509_up_ref(certificate);
  return Certificate(certificate);
}

// What the client has sent, its own certificate first.
std::vector<Certificate> ChainOf(X509_STORE_CTX* context) {
  std::vector<Certificate> chain{Shared(X509_STORE_CTX_get0_cert(context))};
  STACK_OF(X509)* const others = X509_STORE_CTX_get0_untrusted(context);
  for (int i = 0; i < sk_X509_num(others) && chain.size() < kChainMax; ++i)
    chain.push_back(Shared(sk_X509_value(others, i)));
  return chain;
}

}  // namespace

struct TlsServer::State {
  OpensslOwner<SSL_CTX, SSL_CTX_free> context{SSL_CTX_new(TLS_server_method())};
  std::optional<Certificate> certificate;
  CheckClient check;

  static int Verify(X509_STORE_CTX* context, void* state);
};

struct TlsStream::State {
  TlsServer server;
  OpensslOwner<SSL, SSL_free> ssl;
  std::string refused;  // why the certificate of the client was
  std::string reason;
};

// Called by OpenSSL, through which no exception may pass.
int TlsServer::State::Verify(X509_STORE_CTX* context, void* state) {
  auto* const ssl =
      static_cast<SSL*>(X509_STORE_CTX_get_ex_data(context, SSL_get_ex_data_X509_STORE_CTX_idx()));
  auto* const stream = static_cast<TlsStream::State*>(SSL_get_app_data(ssl));
  try {
    const auto checked = static_cast<const State*>(state)->check(ChainOf(context));
    if (checked) return 1;
    stream->refused = checked.error().message;
  } catch (const std::exception&) {
    // For lack of memory.
  }
  X509_STORE_CTX_set_error(context, X509_V_ERR_APPLICATION_VERIFICATION);
  return 0;
}

Result<TlsServer> TlsServer::Make(const std::string& key_pem, const std::string& certificate_pem,
                                  const std::vector<Certificate>& authorities, CheckClient check) {
  const auto key = PrivateKey::FromPem(key_pem, "the key of the server");
  if (!key) return key.error();
  const auto chain = Certificate::ChainFromPem(certificate_pem, "the certificate of the server");
  if (!chain) return chain.error();
  auto state = std::make_shared<State>();
  SSL_CTX* const context = state->context.get();
  TESSERA_CHECK(context != nullptr);
  SSL_CTX_set_min_proto_version(context, TLS1_3_VERSION);
  if (SSL_CTX_use_certificate(context, chain->front().get()) != 1 ||
      SSL_CTX_use_PrivateKey(context, key->get()) != 1 || SSL_CTX_check_private_key(context) != 1)
    return BadInput("the key of the server is not that of its certificate");
  for (size_t i = 1; i < chain->size(); ++i) SSL_CTX_add1_chain_cert(context, (*chain)[i].get());
  for (const Certificate& each : authorities) SSL_CTX_add_client_CA(context, each.get());
  SSL_CTX_set_session_cache_mode(context, SSL_SESS_CACHE_OFF);
  SSL_CTX_set_num_tickets(context, 0);
  SSL_CTX_set_max_cert_list(context, kClientChainBytesMax);
  SSL_CTX_set_mode(context, SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER |
                                SSL_MODE_RELEASE_BUFFERS);
  SSL_CTX_set_alpn_select_cb(context, SelectProtocol, nullptr);
  SSL_CTX_set_verify(context, SSL_VERIFY_PEER, nullptr);
  SSL_CTX_set_cert_verify_callback(context, State::Verify, state.get());
  state->certificate = chain->front();
  state->check = std::move(check);
  return TlsServer(std::move(state));
}

const Certificate& TlsServer::certificate() const {
  return *state_->certificate;
}

TlsStream::TlsStream(const TlsServer& server, int socket) : state_(new State{server, nullptr, "", ""}) {
  state_->ssl.reset(SSL_new(server.state_->context.get()));
  TESSERA_CHECK(state_->ssl != nullptr);
  SSL_set_app_data(state_->ssl.get(), state_.get());
  BIO* const bio = MakeSocketBio(socket);
  SSL_set_bio(state_->ssl.get(), bio, bio);
  SSL_set_accept_state(state_->ssl.get());
}

TlsStream::~TlsStream() = default;
TlsStream::TlsStream(TlsStream&&) noexcept = default;
TlsStream& TlsStream::operator=(TlsStream&&) noexcept = default;

TlsStream::Step TlsStream::After(int result) {
  if (result > 0) return Step::kDone;
  switch (SSL_get_error(state_->ssl.get(), result)) {
    case SSL_ERROR_WANT_READ: return Step::kAwaitRead;
    case SSL_ERROR_WANT_WRITE: return Step::kAwaitWrite;
    default: break;
  }
  const char* const reason = ERR_reason_error_string(ERR_peek_last_error());
  state_->reason = !state_->refused.empty() ? state_->refused : reason != nullptr ? reason : "";
  return Step::kFailed;
}

TlsStream::Step TlsStream::Handshake() {
  ERR_clear_error();
  return After(SSL_do_handshake(state_->ssl.get()));
}

TlsStream::Step TlsStream::Read(char* bytes, size_t size, size_t& received) {
  ERR_clear_error();
  const int result = SSL_read(state_->ssl.get(), bytes, static_cast<int>(size));
  received = result > 0 ? static_cast<size_t>(result) : 0;
  return After(result);
}

TlsStream::Step TlsStream::Write(std::string_view bytes, size_t& sent) {
  ERR_clear_error();
  const size_t size = std::min(bytes.size(), kRecordBytesMax);
  const int result = SSL_write(state_->ssl.get(), bytes.data(), static_cast<int>(size));
  sent = result > 0 ? static_cast<size_t>(result) : 0;
  return After(result);
}

void TlsStream::Close() {
  ERR_clear_error();
  SSL_shutdown(state_->ssl.get());
}

std::optional<Certificate> TlsStream::PeerCertificate() const {
  X509* const shown = SSL_get1_peer_certificate(state_->ssl.get());
  return shown != nullptr ? std::optional(Certificate(shown)) : std::nullopt;
}

const std::string& TlsStream::reason() const {
  return state_->reason;
}

}  // namespace tessera
