#include "client/reach_coordinator.h"

#include <fmt/format.h>

namespace tessera {

Result<std::unique_ptr<CoordinatorClient>> ReachCoordinator(const Options& options,
                                                            Cancellation& cancellation) {
  const auto say = [&] {
    fmt::print(stderr, "tessera: {} does not answer; waiting for it up to {:.0f} s\n", options.coordinator,
               std::chrono::duration<double>(options.patience).count());
  };
  return CoordinatorClient::Connect(options.coordinator, options.patience, cancellation.token(), say);
}

}  // namespace tessera
