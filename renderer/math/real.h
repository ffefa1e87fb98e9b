// Operations on a float under the names that lanes.h gives them for eight, so that a function template serves
// both.
#pragma once

#include <algorithm>
#include <cmath>

namespace tessera {

// `a` if the condition holds, else `b`. Both are computed.
inline float Select(bool condition, float a, float b) {
  return condition ? a : b;
}
inline float Abs(float a) {
  return std::abs(a);
}
inline float Sqrt(float a) {
  return std::sqrt(a);
}
inline float Min(float a, float b) {
  return std::min(a, b);
}

}  // namespace tessera
