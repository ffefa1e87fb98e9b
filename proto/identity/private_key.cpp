#include "proto/identity/private_key.h"

#include <fmt/format.h>

#include "proto/identity/openssl_handles.h"

namespace tessera {
namespace {

// Refuses keys with a passphrase: programs that start by themselves cannot be asked for it.
int NoPassphrase(char*, int, int, void*) {
  return -1;
}

}  // namespace

PrivateKey::PrivateKey(evp_pkey_st* key) : key_(key, EVP_PKEY_free) {
  TESSERA_CHECK(key != nullptr);
}

PrivateKey PrivateKey::Generate() {
  return PrivateKey(EVP_EC_gen("P-256"));
}

PrivateKey PrivateKey::FromSeed(const std::array<uint8_t, 32>& seed) {
  return PrivateKey(EVP_PKEY_new_raw_private_key(EVP_PKEY_ED25519, nullptr, seed.data(), seed.size()));
}

Result<PrivateKey> PrivateKey::FromPem(std::string_view pem, const std::string& what) {
  if (pem.size() > kPemBytesMax)
    return BadInput(fmt::format("{}: is too large for a key (limit {} bytes)", what, kPemBytesMax));
  EVP_PKEY* const key = PEM_read_bio_PrivateKey(ReadOnlyBio(pem).get(), nullptr, NoPassphrase, nullptr);
  if (key == nullptr)
    return BadInput(fmt::format("{}: holds no private key in PEM form without a passphrase", what));
  return PrivateKey(key);
}

std::string PrivateKey::Pem() const {
  return BioText([this](BIO* bio) {
    return PEM_write_bio_PKCS8PrivateKey(bio, key_.get(), nullptr, nullptr, 0, nullptr, nullptr);
  });
}

Digest PrivateKey::PublicDigest() const {
  return Sha256(BioText([this](BIO* bio) { return i2d_PUBKEY_bio(bio, key_.get()); }));
}

}  // namespace tessera
