#include "proto/shell/system.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <random>

#include "renderer/util/check.h"

namespace tessera {

uint64_t RandomId() {
  std::random_device device;
  const uint64_t high = device();
  const uint64_t low = device();
  return (high << 32 | low) | 1;
}

FarmId RandomFarmId() {
  FarmId id;
  // It cannot fail for so few bytes.
  TESSERA_CHECK(::getentropy(&id, sizeof id) == 0);
  return id;
}

bool CanConnect(const std::string& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.size() >= sizeof name.sun_path) return false;
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return false;
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  const bool connected = ::connect(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0;
  ::close(socket);
  return connected;
}

}  // namespace tessera
