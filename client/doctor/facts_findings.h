// What the answers of a coordinator mean for this machine and for the farm.
#pragma once

#include <string>

#include "client/coordinator/coordinator_facts.h"
#include "client/doctor/finding.h"

namespace tessera {

// Versions, clocks, and the workers if they are known.
Findings FindingsOf(const std::string& where, const CoordinatorFacts& facts);

}  // namespace tessera
