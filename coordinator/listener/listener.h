// Listens on the addresses of the coordinator and accepts connections on a thread of its own. gRPC's own
// listener stops accepting for good after the process has once run out of descriptors, so it never gets that
// far: this one refuses connections that would use the reserve (descriptors.h), and waits if there is no
// descriptor at all.
#pragma once

#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "coordinator/listener/pending_connections.h"
#include "proto/shell/rare_log.h"
#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace tessera {

class Listener {
 public:
  // Takes over an open connection to an address of this kind. Called on the thread of the listener.
  using OnConnection = std::function<void(int connection, Address::Kind kind)>;

  // Binds all addresses. An error that names the address if one cannot be listened on.
  static Result<std::unique_ptr<Listener>> Open(const std::vector<Address>& addresses);
  ~Listener();  // Stop
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  // Where it listens, with the ports that were chosen for port 0.
  const std::vector<Address>& addresses() const { return addresses_; }
  // Also listens on a socket for each of these addresses for which there is one (local_socket.h). Returns why
  // that is not possible; then programs of this user need a login too. Call it before Start.
  Result<void> OpenLocalSockets(const std::string& folder);
  // Accepts connections until Stop. Call it once. TCP connections count as pending in `pending`, if it is not
  // null, and those that it refuses are closed.
  void Start(std::shared_ptr<PendingConnections> pending, OnConnection on_connection);
  // Accepts no more connections and removes the Unix sockets. The last call of `on_connection` has returned.
  void Stop();

 private:
  static constexpr std::chrono::seconds kLogInterval{10};

  Listener() = default;
  struct Socket {
    int fd = -1;
    Address::Kind kind{};
  };

  Result<void> Bind(Address& address);
  void Run(const OnConnection& on_connection);
  void AcceptAll(const Socket& socket, const OnConnection& on_connection);
  // Whether the connection may be passed on. Closes it if not.
  bool MayPass(int connection, Address::Kind kind, const sockaddr_storage& peer);

  std::vector<Address> addresses_, local_sockets_;
  std::vector<Socket> sockets_;
  std::shared_ptr<PendingConnections> pending_;
  int stop_event_ = -1;
  RareLog refused_{kLogInterval}, crowded_{kLogInterval}, failed_{kLogInterval};
  std::thread thread_;
};

}  // namespace tessera
