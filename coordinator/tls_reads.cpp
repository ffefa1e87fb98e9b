#include "coordinator/tls_reads.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include <exception>
#include <new>

#include "coordinator/listener/header_limit.h"
#include "proto/identity/certificate.h"
#include "proto/identity/subject.h"
#include "proto/shell/rare_log.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kLogInterval{10};
constexpr int kClosedLogged = 10;

using ReadFunction = int (*)(SSL*, void*, int);

ReadFunction OriginalRead() {
  static const auto original = reinterpret_cast<ReadFunction>(::dlsym(RTLD_NEXT, "SSL_read"));
  TESSERA_CHECK(original != nullptr);
  return original;
}

void DeleteLimit(void*, void* limit, CRYPTO_EX_DATA*, int, long, void*) {
  delete static_cast<HeaderLimit*>(limit);
}

// That of a connection, which owns it. nullptr if there is no memory for one.
HeaderLimit* LimitOf(SSL* ssl) {
  static const int index = SSL_get_ex_new_index(0, nullptr, nullptr, nullptr, DeleteLimit);
  if (auto* const known = static_cast<HeaderLimit*>(SSL_get_ex_data(ssl, index))) return known;
  auto* const made = new (std::nothrow) HeaderLimit;
  if (made != nullptr && SSL_set_ex_data(ssl, index, made) == 1) return made;
  delete made;
  return nullptr;
}

std::string HolderText(SSL* ssl) {
  X509* const shown = SSL_get1_peer_certificate(ssl);
  if (shown == nullptr) return "unknown";
  const auto subject = Subject::Parse(Certificate(shown).Uri());
  if (!subject) return "unknown";
  return subject->IsMember() ? fmt::format("member={}", MemberIdText(subject->id))
                             : fmt::format("token={}", TokenIdText(subject->token_key));
}

void LogClosed(SSL* ssl) {
  static RareLog closed{kLogInterval, kClosedLogged};
  try {
    closed.Warn("connection_closed", fmt::format("{} reason=\"the headers of a request exceed {} bytes\"",
                                                 HolderText(ssl), kHeaderBlockBytesMax));
  } catch (const std::exception&) {
    // Without memory for the line, the connection is closed all the same.
  }
}

bool MayPass(SSL* ssl, const void* bytes, int size) {
  HeaderLimit* const limit = LimitOf(ssl);
  if (limit == nullptr) return false;
  if (limit->Take({static_cast<const unsigned char*>(bytes), static_cast<size_t>(size)})) return true;
  LogClosed(ssl);
  return false;
}

}  // namespace
}  // namespace tessera

// The error makes SSL_get_error report that the connection cannot be used any more.
extern "C" [[gnu::visibility("default")]] int SSL_read(SSL* ssl, void* bytes, int size) {
  const int received = tessera::OriginalRead()(ssl, bytes, size);
  if (received <= 0 || SSL_is_server(ssl) == 0 || tessera::MayPass(ssl, bytes, received)) return received;
  ERR_raise(ERR_LIB_USER, ERR_R_OPERATION_FAIL);
  return -1;
}

namespace tessera {

Result<void> CheckTlsReads() {
  if (::dlsym(RTLD_DEFAULT, "SSL_read") == reinterpret_cast<void*>(&SSL_read)) return {};
  return Failed(
      "this build of gRPC does not use the shared library of OpenSSL, so the headers of requests are "
      "unlimited");
}

}  // namespace tessera
