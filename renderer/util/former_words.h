// What pbrt-v4 calls the words of pbrt-v3 that it no longer knows.
#pragma once

#include <span>
#include <string_view>

namespace tessera {

// The candidate that has replaced `word`; empty if none has.
std::string_view SuccessorOf(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace tessera
