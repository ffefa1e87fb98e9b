// The listening end: services, addresses, threads of gRPC.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace grpc {
class Server;
}

namespace tessera {

class BlobService;
class JobsService;
class WorkService;

class CoordinatorServer {
 public:
  // An error that names the address if one cannot be listened on. The services must outlive the server.
  static Result<std::unique_ptr<CoordinatorServer>> Start(const std::vector<Address>& listen,
                                                          WorkService& work, BlobService& blobs,
                                                          JobsService& jobs);
  ~CoordinatorServer();
  // As listened on: with the port that was chosen for port 0.
  const std::vector<Address>& addresses() const { return addresses_; }
  // Takes no new calls and waits a little for those that run, then breaks them off.
  void Shutdown();

 private:
  CoordinatorServer();
  std::vector<Address> addresses_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace tessera
