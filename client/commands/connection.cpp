#include "client/commands/connection.h"

#include <fmt/format.h>

#include "proto/shell/console.h"

namespace tessera {

Result<std::unique_ptr<CoordinatorClient>> Connect(const ConnectionOptions& options,
                                                   Cancellation& cancellation) {
  const auto print_waiting = [&](const std::string& reason) {
    PrintNote("tessera: the coordinator at {} does not answer: {}; waiting for it up to {:.0f} s\n",
              options.coordinator, reason, std::chrono::duration<double>(options.patience).count());
  };
  return CoordinatorClient::Connect(options.coordinator, options.patience, cancellation.token(),
                                    print_waiting);
}

}  // namespace tessera
