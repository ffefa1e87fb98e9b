// Watches what gRPC reads from encrypted connections and ends those whose requests have headers without an
// end (header_limit.h). gRPC has no limit for them and no place between TLS and HTTP/2 for code of others. It
// calls SSL_read of OpenSSL's shared library, and the linker prefers the function of that name in the
// program, which is here. It calls the original one.
#pragma once

#include "renderer/util/result.h"

namespace tessera {

// An error if gRPC does not use the function here, such as one that has its own copy of OpenSSL.
Result<void> CheckTlsReads();

}  // namespace tessera
