#include "coordinator/server.h"

#include <grpc/support/log.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <spdlog/spdlog.h>

#include "coordinator/listener/listener.h"
#include "coordinator/listener/pending_connections.h"
#include "coordinator/tls_reads.h"
#include "proto/wire/channel.h"
#include "proto/wire/local_socket.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kShutdownPatience{1000};

}  // namespace

CoordinatorServer::CoordinatorServer() = default;
CoordinatorServer::~CoordinatorServer() = default;

Result<std::unique_ptr<CoordinatorServer>> CoordinatorServer::Start(
    std::unique_ptr<Listener> listener, const ServerSecurity& security,
    const std::vector<grpc::Service*>& services) {
  // Errors are reported by this program, on one line.
  gpr_set_log_function([](gpr_log_func_args*) {});
  if (!security.socket_folder.empty()) {
    const SocketFolderLock lock(security.socket_folder);
    if (const int removed = RemoveStaleSockets(security.socket_folder); removed > 0)
      spdlog::info("stale_sockets_removed count={} folder={}", removed, LogText(security.socket_folder));
    if (const auto opened = listener->OpenLocalSockets(security.socket_folder); !opened)
      spdlog::warn("local_socket_unavailable reason={}", LogText(opened.error().message));
  }
  grpc::ServerBuilder builder;
  ConfigureServer(builder);
  const auto accept = [&](std::shared_ptr<grpc::ServerCredentials> credentials) {
    return builder.experimental().AddExternalConnectionAcceptor(
        grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD, std::move(credentials));
  };
  std::unique_ptr<CoordinatorServer> server(new CoordinatorServer);
  server->plain_ = accept(grpc::InsecureServerCredentials());
  if (!security.identity_path.empty()) {
    if (const auto limited = CheckTlsReads(); !limited) return limited.error();
    server->encrypted_ =
        accept(TlsServerCredentials(security.identity_path, security.identity_path, security.admit));
  }
  for (grpc::Service* const service : services) builder.RegisterService(service);
  server->server_ = builder.BuildAndStart();
  if (server->server_ == nullptr) return Failed("cannot start the gRPC server");
  server->listener_ = std::move(listener);
  const auto pending = server->encrypted_ != nullptr ? security.pending : nullptr;
  server->listener_->Start(pending, [raw = server.get()](int connection, Address::Kind kind) {
    const bool is_encrypted = kind == Address::Kind::kTcp && raw->encrypted_ != nullptr;
    grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters parameters;
    parameters.fd = connection;
    (is_encrypted ? raw->encrypted_ : raw->plain_)->HandleNewConnection(&parameters);
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
