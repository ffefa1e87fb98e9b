// What a Bxdf can do. (The kinds themselves are added beside this file.)
#pragma once

#include <cstdint>

namespace tessera {

enum class BxdfFlags : uint8_t {
  kNone = 0,
  kReflection = 1,
  kTransmission = 2,
  kDiffuse = 4,
  kGlossy = 8,
  kSpecular = 16,
};
constexpr BxdfFlags operator|(BxdfFlags a, BxdfFlags b) {
  return static_cast<BxdfFlags>(static_cast<uint8_t>(a) | static_cast<uint8_t>(b));
}
constexpr bool HasFlag(BxdfFlags flags, BxdfFlags flag) {
  return (static_cast<uint8_t>(flags) & static_cast<uint8_t>(flag)) != 0;
}

}  // namespace tessera
