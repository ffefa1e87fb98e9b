// Sockets that listen. They do not block and are not inherited.
#pragma once

#include <string>
#include <vector>

namespace tessera {

// Sockets on all addresses of the host, with one port; port 0 becomes the one that was chosen. A wildcard
// means both versions of IP. Returns none if that is not possible.
std::vector<int> ListenOnHost(const std::string& host, int& port);

// A socket at the path, with mode 0600, which replaces a socket that is there. Returns -1 if that is not
// possible.
int ListenOnPath(const std::string& path);

// Whether an attempt to accept a connection that failed with this errno fails again immediately, although a
// connection waits: the caller must pause.
bool IsLastingAcceptFailure(int error);

}  // namespace tessera
