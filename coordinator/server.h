// The gRPC server: services, addresses and threads.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace grpc {
class Server;
namespace experimental {
class ExternalConnectionAcceptor;
}
}  // namespace grpc

namespace tessera {

class BlobService;
class JobsService;
class Listener;
class WorkService;

class CoordinatorServer {
 public:
  // An error that names the address if one cannot be listened on. The services must outlive the server.
  static Result<std::unique_ptr<CoordinatorServer>> Start(const std::vector<Address>& listen,
                                                          WorkService& work, BlobService& blobs,
                                                          JobsService& jobs);
  ~CoordinatorServer();
  // Where it listens, with the ports that were chosen for port 0.
  const std::vector<Address>& addresses() const;
  // Accepts no new calls, waits a moment for running calls, then cancels them.
  void Shutdown();

 private:
  CoordinatorServer();
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<Listener> listener_;
};

}  // namespace tessera
