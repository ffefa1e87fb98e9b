#include "worker/machine_id.h"

#include <fstream>
#include <string>

#include "renderer/util/digest.h"

namespace tessera {

// Containers have machine ids (/etc/machine-id) of their own or none, but share the running kernel.
uint64_t MachineId() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string boot;
  if (!std::getline(file, boot) || boot.empty()) return 0;
  const Digest digest = Sha256("tessera machine " + boot);
  uint64_t id = 0;
  for (size_t i = 0; i < sizeof(id); ++i) id = id << 8 | digest.bytes[i];
  return id;
}

}  // namespace tessera
