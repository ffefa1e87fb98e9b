#include "client/commands/connection.h"

#include <fmt/format.h>

#include "proto/shell/console.h"

namespace tessera {

Result<std::unique_ptr<CoordinatorClient>> Connect(const ConnectionOptions& options,
                                                   Cancellation& cancellation) {
  const auto endpoint = ChooseFarm(options.farm);
  if (!endpoint) return endpoint.error();
  const auto print_waiting = [&](const std::string& reason) {
    PrintNote("tessera: the coordinator at {} does not answer: {}; waiting for it up to {:.0f} s\n",
              endpoint->address.Text(), reason,
              std::chrono::duration<double>(options.patience.connection).count());
  };
  return CoordinatorClient::Connect(*endpoint, options.patience, cancellation.token(), print_waiting);
}

}  // namespace tessera
