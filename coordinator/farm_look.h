// A look at the farm for the web pages.
#pragma once

#include <optional>

#include "coordinator/web/farm_view.h"

namespace tessera {

class CoreThread;

// Asks the core thread; returns nullopt if it does not answer in time. The caller fills in `traffic`,
// `intake` and `blob_bytes`.
std::optional<FarmView> LookAtFarm(CoreThread& core);

}  // namespace tessera
