// The TCP addresses that a process listens on, from what the kernel shows of it.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "proto/wire/address.h"

namespace tessera {

// Empty if the process is gone or belongs to another user.
std::vector<Address> ListeningAddresses(pid_t process);

// The address in a line of /proc/net/tcp or tcp6, such as 0100007F:1E14. Returns nullopt for other text.
std::optional<Address> ParseKernelAddress(const std::string& text);

}  // namespace tessera
