// Checks of this machine, whatever it does for a farm: limits and clock.
#pragma once

#include "client/doctor/finding.h"

namespace tessera {

Findings CheckMachine();

}  // namespace tessera
