// Private keys. Those of members, coordinators and authorities are ECDSA keys of the curve P-256: every
// TLS 1.3 library and every browser accepts them. The key of a join token is an Ed25519 key, because any 32
// bytes make one.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "renderer/util/digest.h"
#include "renderer/util/result.h"

struct evp_pkey_st;  // OpenSSL's EVP_PKEY

namespace tessera {

// Of one PEM file or message: a key and some certificates have less than 4 KiB.
constexpr size_t kPemBytesMax = 64 << 10;

// Copies share the key, which never changes. Thread safe.
class PrivateKey {
 public:
  // A new random key.
  static PrivateKey Generate();
  // The Ed25519 key with this seed.
  static PrivateKey FromSeed(const std::array<uint8_t, 32>& seed);
  // The key in some PEM text; `what` names the text in errors. A key with a passphrase is refused.
  static Result<PrivateKey> FromPem(std::string_view pem, const std::string& what);

  std::string Pem() const;  // PKCS #8
  // SHA-256 of the public key (of its SubjectPublicKeyInfo).
  Digest PublicDigest() const;
  evp_pkey_st* get() const { return key_.get(); }

 private:
  explicit PrivateKey(evp_pkey_st* key);
  std::shared_ptr<evp_pkey_st> key_;
};

}  // namespace tessera
