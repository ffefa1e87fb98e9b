// The gRPC server: services, addresses and threads.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "proto/wire/address.h"
#include "proto/wire/tls_credentials.h"
#include "renderer/util/result.h"

namespace grpc {
class Server;
class Service;
namespace experimental {
class ExternalConnectionAcceptor;
}
}  // namespace grpc

namespace tessera {

class Listener;
class PendingConnections;

// Of TCP connections; those to Unix sockets are plain.
struct ServerSecurity {
  // Key and certificates of the coordinator (tls_credentials.h). Empty: TCP connections are plain too.
  std::string identity_path;
  AdmitPeer admit;
  // Those of them that have not made a call yet.
  std::shared_ptr<PendingConnections> pending;
  // Where to listen for programs of this user (local_socket.h); empty: nowhere.
  std::string socket_folder;
};

class CoordinatorServer {
 public:
  // Serves the connections of `listener`. The services must outlive the server.
  static Result<std::unique_ptr<CoordinatorServer>> Start(std::unique_ptr<Listener> listener,
                                                          const ServerSecurity& security,
                                                          const std::vector<grpc::Service*>& services);
  ~CoordinatorServer();
  // Where it listens, with the ports that were chosen for port 0.
  const std::vector<Address>& addresses() const;
  // Accepts no new calls, waits a moment for running calls, then cancels them.
  void Shutdown();

 private:
  CoordinatorServer();
  // Of plain connections, and of encrypted ones if there are any.
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> plain_, encrypted_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<Listener> listener_;
};

}  // namespace tessera
