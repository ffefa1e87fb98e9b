// A join token: what a machine or a person needs to become a member of a farm, in one word.
//
// The token holds a random secret, from which both sides derive the same key pair. The new member proves
// possession of the key in the TLS handshake, so the secret itself is never sent, and a coordinator stores
// only the digest of the public key. The fingerprint shows whether the right coordinator answers.
//
// The text is "tessera-" and the base64url form of: version (1 byte), secret (16), fingerprint (32), address,
// and the first 4 bytes of the SHA-256 of all that, which detects a word that was not copied whole.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "proto/identity/certificate.h"
#include "proto/identity/private_key.h"

namespace tessera {

struct JoinToken {
  std::string address;  // HOST:PORT of the coordinator
  Digest authority;     // fingerprint of its authority's certificate
  std::array<uint8_t, 16> secret{};

  bool operator==(const JoinToken&) const = default;
  // A token with a new secret.
  static JoinToken Make(std::string address, const Digest& authority);
  std::string Text() const;
  // The text of these bytes with their checksum, whether or not they are those of a token.
  static std::string TextOf(std::string_view bytes);
  static Result<JoinToken> Parse(std::string_view text);
  PrivateKey Key() const;
  // The certificate that is shown in the handshake.
  Certificate MakeCertificate(UnixTime now) const;
};

}  // namespace tessera
