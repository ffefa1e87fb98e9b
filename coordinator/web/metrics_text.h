// The metrics of a farm, as Prometheus reads them.
#pragma once

#include <string>

#include "coordinator/web/farm_view.h"

namespace tessera {

// The text exposition format, version 0.0.4. Counters start at 0 in each coordinator process.
std::string MetricsText(const FarmView& view);

}  // namespace tessera
