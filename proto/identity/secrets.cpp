#include "proto/identity/secrets.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>

#include "renderer/util/check.h"

namespace tessera {
namespace {

const unsigned char* Bytes(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

}  // namespace

std::string RandomSecret() {
  Digest random;
  TESSERA_CHECK(RAND_bytes(random.bytes.data(), static_cast<int>(random.bytes.size())) == 1);
  return random.Hex();
}

bool AreEqualSecrets(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

Digest KeyedDigest(std::string_view key, std::string_view text) {
  Digest digest;
  unsigned size = 0;
  TESSERA_CHECK(HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()), Bytes(text), text.size(),
                     digest.bytes.data(), &size) != nullptr &&
                size == digest.bytes.size());
  return digest;
}

std::string Base64(std::string_view bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // OpenSSL ends it with a zero byte
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), Bytes(bytes),
                                   static_cast<int>(bytes.size()));
  text.resize(static_cast<size_t>(size));
  return text;
}

}  // namespace tessera
