// Where a coordinator that listens on a TCP address also listens for programs of the same user on the same
// machine: a Unix socket in a folder of the user, named after the address. Such programs need no certificate,
// because the kernel lets nobody else in.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace tessera {

using ReadVariable = std::function<std::string(const char* variable)>;

// tessera in $XDG_RUNTIME_DIR, tessera in /run/user/UID, or tessera-UID in $TMPDIR or /tmp: the first that
// the system provides.
std::string LocalSocketFolder(const ReadVariable& environment);
// Creates the folder with mode 0700, or checks that it belongs to this user alone.
Result<void> PrepareLocalSocketFolder(const std::string& folder);

// Keeps other coordinators of this user from opening sockets in the folder while it exists, so that none is
// seen between being named and listening. Waits for them. Does nothing if the folder does not exist.
class SocketFolderLock {
 public:
  explicit SocketFolderLock(const std::string& folder);
  ~SocketFolderLock();
  SocketFolderLock(const SocketFolderLock&) = delete;
  SocketFolderLock& operator=(const SocketFolderLock&) = delete;

 private:
  int folder_;
};

// Removes sockets of this user in the folder on which nobody listens, such as those of coordinators that were
// killed. Call it with a lock. Returns how many.
int RemoveStaleSockets(const std::string& folder);

// The socket of a TCP address that this machine alone can reach, or that stands for all addresses of this
// machine. Returns nullopt for others, and if the path would be too long for a socket.
std::optional<Address> LocalSocketOf(const Address& address, const std::string& folder);

// Whether a program of this user listens on the socket.
bool IsListening(const Address& socket);

}  // namespace tessera
