// How OpenSSL reads from and writes to sockets here. Only the sources of this folder include this.
#pragma once

#include <openssl/bio.h>

namespace tessera {

// For a socket that does not block and stays the caller's. OpenSSL's own way to write to one ends the process
// with SIGPIPE if the other end has closed it.
BIO* MakeSocketBio(int socket);

}  // namespace tessera
