// What the web pages show of the farm.
#pragma once

#include <optional>

#include "coordinator/web/farm_view.h"

namespace tessera {

class CoreThread;

// Asks the core thread; returns nullopt if it does not answer in time. The caller fills in `traffic`,
// `intake`, `blob_bytes`, `disk_free` and `disk_total`.
std::optional<FarmView> ReadFarmView(CoreThread& core);

}  // namespace tessera
