// Leases of a process of the coordinator that ran before the one under test, which must have epoch 2 or more:
// so tests return whatever results they like without being asked for them.
#pragma once

#include "proto/terms.h"

namespace tessera {

constexpr uint32_t kLaterEpoch = 2;

inline LeaseId FormerLease(uint64_t number = 1) {
  return {uint64_t{1} << 40 | (number + 1), 4711};
}

}  // namespace tessera
