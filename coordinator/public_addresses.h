// The addresses to give to others who want to reach the coordinator.
#pragma once

#include <string>
#include <vector>

#include "proto/wire/address.h"

namespace tessera {

// `listen` with the ports that were chosen. `names` stand for all addresses of this machine. The most useful
// come first: names that the user chose (`names_are_chosen`), then IPv4 addresses, then other names, and last
// what only this machine can reach.
std::vector<std::string> PublicAddresses(const std::vector<Address>& listen, std::vector<std::string> names,
                                         bool names_are_chosen);

}  // namespace tessera
