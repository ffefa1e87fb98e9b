#include "proto/wire/channel.h"

#include <fmt/format.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/server_builder.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/channel_arguments.h>

#include "proto/identity/subject.h"
#include "proto/terms.h"
#include "proto/wire/endpoint.h"
#include "proto/wire/tls_credentials.h"
#include "renderer/text/unicode.h"
#include "renderer/util/cores.h"
#include "renderer/util/threads.h"

namespace tessera {
namespace {

// Keepalive detects connections whose other end has vanished, such as by a pulled cable. TCP alone takes
// minutes.
constexpr int kKeepaliveTime_ms = 10'000;
constexpr int kKeepaliveTimeout_ms = 10'000;
// The server's tolerance. It must be less than the clients' interval, or the server answers GOAWAY.
constexpr int kPingIntervalMin_ms = 5'000;
// A connection that does not complete the handshake of HTTP/2 in this time is closed. So is one that makes
// no call for a while: those of workers and clients are opened again when they are needed.
constexpr int kHandshakeTimeout_ms = 10'000;
constexpr int kIdleTimeout_ms = 120'000;
// Calls that one connection may have open: a worker has less than a dozen, a client that uploads no more.
// Further calls wait at the other end.
constexpr int kCallsPerConnectionMax = 128;
// What gRPC may hold of messages that are being received or sent, over all connections. Calls are cancelled
// when more arrives, those of workers to be repeated.
constexpr size_t kServerMemoryBytes = size_t{192} << 20;
// Back-off between attempts to connect. Short enough for a restarted coordinator to have its farm back within
// seconds.
constexpr int kReconnectFirst_ms = 100;
constexpr int kReconnectMax_ms = 3'000;
// Of an attempt to connect with its handshake. A link that delays and loses packets needs a second or two.
constexpr int kConnectPatience_ms = 5'000;
// Of an error that travels as a status: a path and a reason. Fits into kStatusBytesMax whatever it holds.
constexpr size_t kErrorBytesMax = 2000;

constexpr const char* kFarmKey = "tessera-farm";

// The threads that gRPC starts when it is first used, besides one for each core.
constexpr int kGrpcThreads = 16;

// Whoever uses gRPC last waits until all of its threads have ended, and for ever if one of them could not be
// started. A channel that is never used and never deleted is a user that does not end.
void KeepGrpcRunning() {
  PrepareTls();  // before there are threads
  // The attribute keeps the pointer, by which leak checkers find the channel, although nothing reads it.
  [[gnu::used]] static const auto* const kept = new std::shared_ptr<grpc::Channel>(
      grpc::CreateChannel("unix:/nowhere", grpc::InsecureChannelCredentials()));
}

// Why a call failed. gRPC itself gives no reason, or one for its developers, if a message cannot be read.
std::string ReasonOf(const grpc::Status& status) {
  const std::string message = CleanText(status.error_message(), kReasonBytesMax);
  const grpc::StatusCode code = status.error_code();
  const bool is_ours = code != grpc::StatusCode::INTERNAL && code != grpc::StatusCode::UNKNOWN;
  if (is_ours && !message.empty()) return message;
  return fmt::format("{} (gRPC status {})",
                     message.empty() ? "the message or its answer could not be read" : message,
                     static_cast<int>(code));
}

// Of a message as it is transferred, where a byte that is not printable takes three. gRPC accepts headers of
// 8 KB at most.
constexpr size_t kStatusBytesMax = 6000;

// `name`: of the server in the handshake, if that is not its address.
std::shared_ptr<grpc::Channel> Open(const Address& address,
                                    const std::shared_ptr<grpc::ChannelCredentials>& credentials,
                                    const char* name) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(static_cast<int>(kMessageBytesMax));
  arguments.SetMaxSendMessageSize(static_cast<int>(kMessageBytesMax));
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveTime_ms);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeout_ms);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kReconnectFirst_ms);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kConnectPatience_ms);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kReconnectMax_ms);
  // The machines of a farm connect directly; a web proxy is not meant for them.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  // Two channels of one process are two connections: the bulk data of a worker does not delay its state.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  if (name != nullptr) arguments.SetSslTargetNameOverride(name);
  return grpc::CreateCustomChannel(address.Target(), credentials, arguments);
}

}  // namespace

Result<void> StartGrpc() {
  if (auto can_start = CheckThreads(kGrpcThreads + UsableCores()); !can_start) return can_start;
  KeepGrpcRunning();
  return {};
}

std::shared_ptr<grpc::Channel> OpenChannel(const Endpoint& endpoint) {
  KeepGrpcRunning();
  if (endpoint.organisation)
    return Open(endpoint.target, TlsClientCredentials(*endpoint.organisation, endpoint.target.host), nullptr);
  if (!endpoint.login) return OpenChannel(endpoint.target);
  return OpenChannel(endpoint.target,
                     TlsClientCredentials(endpoint.login->AuthorityPath(), endpoint.login->IdentityPath()));
}

std::shared_ptr<grpc::Channel> OpenChannel(const Address& address) {
  KeepGrpcRunning();
  return OpenChannel(address, grpc::InsecureChannelCredentials());
}

std::shared_ptr<grpc::Channel> OpenChannel(const Address& address,
                                           const std::shared_ptr<grpc::ChannelCredentials>& credentials) {
  KeepGrpcRunning();
  return Open(address, credentials, kCoordinatorName);
}

void ConfigureServer(grpc::ServerBuilder& builder) {
  KeepGrpcRunning();
  builder.SetMaxReceiveMessageSize(static_cast<int>(kMessageBytesMax));
  builder.SetMaxSendMessageSize(static_cast<int>(kMessageBytesMax));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveTime_ms);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeout_ms);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kPingIntervalMin_ms);
  // Our data is compressed where that helps, and a small compressed message can be a huge one.
  builder.SetCompressionAlgorithmSupportStatus(GRPC_COMPRESS_DEFLATE, false);
  builder.SetCompressionAlgorithmSupportStatus(GRPC_COMPRESS_GZIP, false);
  builder.AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
  grpc::ResourceQuota quota("coordinator");
  quota.Resize(kServerMemoryBytes);
  builder.SetResourceQuota(quota);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeTimeout_ms);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, kIdleTimeout_ms);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kCallsPerConnectionMax);
}

bool WaitForConnection(grpc::Channel& channel, std::chrono::milliseconds patience) {
  return channel.WaitForConnected(std::chrono::system_clock::now() + patience);
}

void SetDeadline(grpc::ClientContext& context, std::chrono::milliseconds duration) {
  context.set_deadline(std::chrono::system_clock::now() + duration);
}

void SetFarm(grpc::ClientContext& context, FarmId farm) {
  if (farm != FarmId{}) context.AddMetadata(kFarmKey, farm.Hex());
}

grpc::Status CheckFarm(const grpc::ServerContextBase& context, FarmId farm) {
  const auto& metadata = context.client_metadata();
  const auto meant = metadata.find(kFarmKey);
  if (meant == metadata.end() || std::string_view(meant->second.data(), meant->second.size()) == farm.Hex())
    return grpc::Status::OK;
  return {grpc::StatusCode::FAILED_PRECONDITION,
          fmt::format("this address now belongs to another farm ({}), whose job numbers mean other jobs",
                      farm.Hex())};
}

grpc::Status ToStatus(const Error& error) {
  const std::string message = CleanText(error.message, kErrorBytesMax);
  switch (error.kind) {
    case ErrorKind::kBadInput: return {grpc::StatusCode::INVALID_ARGUMENT, message};
    case ErrorKind::kInterrupted: return {grpc::StatusCode::CANCELLED, message};
    case ErrorKind::kFailed: break;
  }
  return {grpc::StatusCode::FAILED_PRECONDITION, message};
}

grpc::Status Shortened(const grpc::Status& status) {
  const std::string& message = status.error_message();
  size_t end = 0, escaped = 0, boundary = 0;
  for (; end < message.size() && escaped <= kStatusBytesMax; ++end) {
    const auto c = static_cast<unsigned char>(message[end]);
    if ((c & 0xc0) != 0x80) boundary = end;
    escaped += c >= 0x20 && c <= 0x7e && c != '%' ? 1 : 3;
  }
  if (escaped <= kStatusBytesMax) return status;
  return {status.error_code(), message.substr(0, boundary) + " ..."};
}

Error ToError(const grpc::Status& status, const std::string& what) {
  TESSERA_CHECK(!status.ok());
  const std::string message = fmt::format("cannot {}: {}", what, ReasonOf(status));
  switch (status.error_code()) {
    case grpc::StatusCode::INVALID_ARGUMENT:
    case grpc::StatusCode::NOT_FOUND: return BadInput(message);
    case grpc::StatusCode::CANCELLED: return {ErrorKind::kInterrupted, message};
    case grpc::StatusCode::UNAVAILABLE:
      return Failed(fmt::format("cannot {}: no answer from the coordinator ({})", what, ReasonOf(status)));
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return Failed(fmt::format("cannot {}: the coordinator did not answer in time", what));
    default: return Failed(message);
  }
}

grpc::Status TryAgain(const std::string& reason) {
  return {grpc::StatusCode::UNAVAILABLE, reason + "; try again"};
}

grpc::Status CoordinatorEnds() {
  return {grpc::StatusCode::UNAVAILABLE, "the coordinator is shutting down"};
}

grpc::Status HasNotJoined() {
  return {grpc::StatusCode::UNAVAILABLE, "the worker has not joined this coordinator yet"};
}

bool IsTransient(const grpc::Status& status) {
  return status.error_code() == grpc::StatusCode::UNAVAILABLE ||
         status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED;
}

}  // namespace tessera
