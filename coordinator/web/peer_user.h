// Who is at the other end of a connection within this machine.
#pragma once

namespace tessera {

// Whether the other end of a TCP socket is a socket of this machine that belongs to the user of this process.
// Asks the kernel (sock_diag(7)); returns false if it does not tell.
bool IsOfOwnUser(int socket);

}  // namespace tessera
