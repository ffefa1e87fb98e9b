// The farm in numbers, as Prometheus reads them.
#pragma once

#include <string>

#include "coordinator/farm_view.h"

namespace tessera {

// The text exposition format, version 0.0.4. Counters begin at 0 with each process of the coordinator.
std::string MetricsText(const FarmView& view);

}  // namespace tessera
