// SHA-256 digests: the names of blobs and the fingerprints of scenes and results.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace tessera {

// The SHA-256 of some bytes.
struct Digest {
  std::array<uint8_t, 32> bytes{};

  auto operator<=>(const Digest&) const = default;
  // 64 lower-case hexadecimal digits.
  std::string Hex() const;
  // Returns nullopt if `hex` is not exactly 64 hexadecimal digits.
  static std::optional<Digest> FromHex(std::string_view hex);
};

Digest Sha256(std::span<const std::byte> bytes);
Digest Sha256(std::string_view bytes);

// SHA-256 of bytes that arrive in pieces.
class Sha256Stream {
 public:
  Sha256Stream();
  ~Sha256Stream();
  Sha256Stream(const Sha256Stream&) = delete;
  Sha256Stream& operator=(const Sha256Stream&) = delete;
  void Add(std::string_view bytes);
  // Call once, last.
  Digest Finish();

 private:
  void* context_;
};

}  // namespace tessera
