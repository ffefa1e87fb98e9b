// Checks of this machine, whatever it does for a farm: limits, clock, and whether it renders the right bits.
#pragma once

#include <string>

#include "client/doctor/finding.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

Findings CheckMachine();

// The finding about the digest of the probe unit that this machine rendered.
Finding CheckProbe(const std::string& where, const Result<Digest>& rendered);

}  // namespace tessera
