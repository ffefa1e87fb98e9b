#include "coordinator/server.h"

#include <fmt/format.h>
#include <grpc/support/log.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include "coordinator/blob_service.h"
#include "coordinator/jobs_service.h"
#include "coordinator/work_service.h"
#include "proto/shell/system.h"
#include "proto/wire/channel.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kShutdownPatience{1000};

// Whether another process listens on a Unix socket: gRPC would take its name away.
bool IsTaken(const Address& address) {
  return address.kind == Address::Kind::kUnix && CanConnect(address.path);
}

Error CannotListen(const Address& address) {
  return Failed(fmt::format("cannot listen on {}: the address is in use or does not belong to this machine",
                            address.Text()));
}

}  // namespace

CoordinatorServer::CoordinatorServer() = default;
CoordinatorServer::~CoordinatorServer() = default;

Result<std::unique_ptr<CoordinatorServer>> CoordinatorServer::Start(const std::vector<Address>& listen,
                                                                    WorkService& work, BlobService& blobs,
                                                                    JobsService& jobs) {
  // Errors are reported by this program, on one line.
  gpr_set_log_function([](gpr_log_func_args*) {});
  grpc::ServerBuilder builder;
  ConfigureServer(builder);
  std::vector<int> ports(listen.size(), -1);
  for (size_t i = 0; i < listen.size(); ++i) {
    if (IsTaken(listen[i])) return CannotListen(listen[i]);
    builder.AddListeningPort(listen[i].Target(), grpc::InsecureServerCredentials(), &ports[i]);
  }
  builder.RegisterService(&work);
  builder.RegisterService(&blobs);
  builder.RegisterService(&jobs);
  std::unique_ptr<CoordinatorServer> server(new CoordinatorServer);
  server->server_ = builder.BuildAndStart();
  if (server->server_ == nullptr) {
    size_t failed = 0;
    while (failed + 1 < listen.size() && ports[failed] > 0) ++failed;
    return CannotListen(listen[failed]);
  }
  server->addresses_ = listen;
  for (size_t i = 0; i < listen.size(); ++i) {
    if (listen[i].kind == Address::Kind::kTcp) server->addresses_[i].port = ports[i];
  }
  return server;
}

void CoordinatorServer::Shutdown() {
  server_->Shutdown(std::chrono::system_clock::now() + kShutdownPatience);
}

}  // namespace tessera
