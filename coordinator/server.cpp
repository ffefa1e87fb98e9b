#include "coordinator/server.h"

#include <grpc/support/log.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include "coordinator/blob_service.h"
#include "coordinator/jobs_service.h"
#include "coordinator/listener.h"
#include "coordinator/work_service.h"
#include "proto/wire/channel.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kShutdownPatience{1000};

}  // namespace

CoordinatorServer::CoordinatorServer() = default;
CoordinatorServer::~CoordinatorServer() = default;

Result<std::unique_ptr<CoordinatorServer>> CoordinatorServer::Start(const std::vector<Address>& listen,
                                                                    WorkService& work, BlobService& blobs,
                                                                    JobsService& jobs) {
  // Errors are reported by this program, on one line.
  gpr_set_log_function([](gpr_log_func_args*) {});
  auto listener = Listener::Open(listen);
  if (!listener) return listener.error();
  grpc::ServerBuilder builder;
  ConfigureServer(builder);
  std::unique_ptr<CoordinatorServer> server(new CoordinatorServer);
  server->acceptor_ = builder.experimental().AddExternalConnectionAcceptor(
      grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD,
      grpc::InsecureServerCredentials());
  builder.RegisterService(&work);
  builder.RegisterService(&blobs);
  builder.RegisterService(&jobs);
  server->server_ = builder.BuildAndStart();
  if (server->server_ == nullptr) return Failed("cannot start the gRPC server");
  server->listener_ = std::move(*listener);
  server->listener_->Start([acceptor = server->acceptor_.get()](int connection) {
    grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters parameters;
    parameters.fd = connection;
    acceptor->HandleNewConnection(&parameters);
  });
  return server;
}

const std::vector<Address>& CoordinatorServer::addresses() const {
  return listener_->addresses();
}

void CoordinatorServer::Shutdown() {
  listener_->Stop();
  server_->Shutdown(std::chrono::system_clock::now() + kShutdownPatience);
}

}  // namespace tessera
