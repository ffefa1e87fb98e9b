#include "proto/identity/join_token.h"

#include <openssl/rand.h>

#include <algorithm>
#include <optional>

#include "proto/identity/authority.h"
#include "proto/identity/subject.h"

namespace tessera {
namespace {

constexpr std::string_view kPrefix = "tessera-";
constexpr char kTokenVersion = 1;
constexpr size_t kCheckBytes = 4;
constexpr size_t kTokenTextMax = 1024;  // an address has at most some 300 bytes
constexpr std::string_view kKeyLabel = "tessera join token key 1";
constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr std::chrono::hours kHandshakeCertificateLifetime{24};

std::string Base64Url(std::string_view bytes) {
  std::string text;
  uint32_t bits = 0;
  int count = 0;
  for (const char byte : bytes) {
    bits = bits << 8 | static_cast<uint8_t>(byte);
    for (count += 8; count >= 6; count -= 6) text += kDigits[bits >> (count - 6) & 63];
  }
  if (count > 0) text += kDigits[bits << (6 - count) & 63];
  return text;
}

std::optional<std::string> FromBase64Url(std::string_view text) {
  std::string bytes;
  uint32_t bits = 0;
  int count = 0;
  for (const char digit : text) {
    const size_t value = kDigits.find(digit);
    if (value == std::string_view::npos) return std::nullopt;
    bits = bits << 6 | static_cast<uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255);
  }
  return bytes;
}

std::string CheckOf(std::string_view bytes) {
  const Digest digest = Sha256(bytes);
  return {digest.bytes.begin(), digest.bytes.begin() + kCheckBytes};
}

}  // namespace

JoinToken JoinToken::Make(std::string address, const Digest& authority) {
  JoinToken token{std::move(address), authority, {}};
  TESSERA_CHECK(RAND_bytes(token.secret.data(), static_cast<int>(token.secret.size())) == 1);
  return token;
}

std::string JoinToken::Text() const {
  std::string bytes(1, kTokenVersion);
  bytes.append(secret.begin(), secret.end());
  bytes.append(authority.bytes.begin(), authority.bytes.end());
  bytes += address;
  return TextOf(bytes);
}

std::string JoinToken::TextOf(std::string_view bytes) {
  return std::string(kPrefix) + Base64Url(std::string(bytes) + CheckOf(bytes));
}

Result<JoinToken> JoinToken::Parse(std::string_view text) {
  const Error damaged = BadInput(
      "the token is damaged: copy the whole word that tessera-coordinator token printed, or ask for another");
  if (!text.starts_with(kPrefix) || text.size() > kTokenTextMax) return damaged;
  const auto bytes = FromBase64Url(text.substr(kPrefix.size()));
  JoinToken token;
  const size_t fixed = 1 + token.secret.size() + token.authority.bytes.size();
  if (!bytes || bytes->size() <= fixed + kCheckBytes) return damaged;
  const std::string_view body(bytes->data(), bytes->size() - kCheckBytes);
  if (CheckOf(body) != bytes->substr(body.size())) return damaged;
  if (body.front() != kTokenVersion)
    return BadInput(
        "the token was made by another version of tessera-coordinator; use the same version of both");
  auto at = body.begin() + 1;
  std::copy_n(at, token.secret.size(), token.secret.begin());
  at += static_cast<std::ptrdiff_t>(token.secret.size());
  std::copy_n(at, token.authority.bytes.size(), token.authority.bytes.begin());
  token.address = body.substr(fixed);
  return token;
}

PrivateKey JoinToken::Key() const {
  Sha256Stream seed;
  seed.Add(kKeyLabel);
  seed.Add({reinterpret_cast<const char*>(secret.data()), secret.size()});
  return PrivateKey::FromSeed(seed.Finish().bytes);
}

Certificate JoinToken::MakeCertificate(UnixTime now) const {
  const PrivateKey key = Key();
  CertificateTerms terms;
  terms.common_name = "tessera join token";
  Subject subject;
  subject.token_key = key.PublicDigest();
  terms.uri = subject.Uri();
  terms.lifetime = kHandshakeCertificateLifetime;
  terms.serial = 1;
  return MakeSelfSigned(key, terms, now);
}

}  // namespace tessera
