// Small services of the operating system that several programs use.
#pragma once

#include <cstdint>
#include <string>

#include "proto/terms.h"

namespace tessera {

// A random number other than 0, for ids that are unique in practice. Thread safe.
uint64_t RandomId();
// 128 random bits of the operating system.
FarmId RandomFarmId();

// Whether a process listens on the Unix socket at `path`.
bool CanConnect(const std::string& path);

}  // namespace tessera
