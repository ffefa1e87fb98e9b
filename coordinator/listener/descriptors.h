// The file descriptors of the process. Connections may use all but a reserve, which belongs to the data
// directory: a coordinator that cannot take another connection can still store results.
#pragma once

namespace tessera {

// Raises the limit of open descriptors as far as the system allows, up to what kConnectionsMax connections
// need. Call it once, before threads are started.
void RaiseDescriptorLimit();

// The number of descriptors that connections may use, at the present limit of the process. The kernel always
// returns the lowest free number, so a new descriptor that is not below this means that they are used up.
int ConnectionDescriptorsMax();

}  // namespace tessera
