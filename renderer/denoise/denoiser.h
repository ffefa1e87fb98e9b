// What pictures can be denoised with.
#pragma once

#include <string_view>

namespace tessera {

enum class Denoiser { kRegression, kOidn };
inline constexpr std::string_view kDenoiserNames[] = {"regression", "oidn"};  // in this order

}  // namespace tessera
