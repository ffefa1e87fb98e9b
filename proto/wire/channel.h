// The settings of connections, the same at both ends.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "proto/terms.h"
#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace grpc {
class Channel;
class ChannelCredentials;
class ClientContext;
class ServerBuilder;
class ServerContextBase;
class Status;
}  // namespace grpc

namespace tessera {

struct Endpoint;

// Starts gRPC and the threads that it always has, or fails if the system grants too few. Once started, gRPC
// runs until the process ends. OpenChannel and ConfigureServer start it too, but cannot fail: call this first
// where other processes may take the threads that the system grants.
Result<void> StartGrpc();

// A connection that is made when it is first used and, with back-off, made again whenever it breaks. Never
// fails: calls on it return UNAVAILABLE while there is no coordinator. Thread safe.
std::shared_ptr<grpc::Channel> OpenChannel(const Endpoint& endpoint);
// The same in plain text.
std::shared_ptr<grpc::Channel> OpenChannel(const Address& address);
// The same with these credentials.
std::shared_ptr<grpc::Channel> OpenChannel(const Address& address,
                                           const std::shared_ptr<grpc::ChannelCredentials>& credentials);

// Message limits and keepalive of a server whose clients use OpenChannel.
void ConfigureServer(grpc::ServerBuilder& builder);

// Waits until the coordinator is reached. Returns false if that takes longer than `patience`.
bool WaitForConnection(grpc::Channel& channel, std::chrono::milliseconds patience);

// Sets the deadline of the call.
void SetDeadline(grpc::ClientContext& context, std::chrono::milliseconds duration);

// Names the farm that the call is meant for, in its metadata. Connections are made again by themselves, and
// the address may lead to another farm then, whose jobs have the same numbers. Does nothing without a farm.
void SetFarm(grpc::ClientContext& context, FarmId farm);
// The error of a call to `farm` that is meant for another.
grpc::Status CheckFarm(const grpc::ServerContextBase& context, FarmId farm);

// The status that carries an error: kBadInput as INVALID_ARGUMENT, kFailed as FAILED_PRECONDITION,
// kInterrupted as CANCELLED.
grpc::Status ToStatus(const Error& error);
// The status with its message shortened to what gRPC can transfer, at a boundary of UTF-8. Every status that
// a server sends goes through here.
grpc::Status Shortened(const grpc::Status& status);
// The error of a failed call. `what` names what was tried, such as "submit the job". INVALID_ARGUMENT and
// NOT_FOUND become kBadInput, CANCELLED kInterrupted, everything else kFailed.
Error ToError(const grpc::Status& status, const std::string& what);
// The answer to a call that is refused because of something that passes by itself, such as a queue that is
// full. Callers try again, with growing pauses. Other refusals have other status codes: repeating the call
// does not help before somebody has changed something.
grpc::Status TryAgain(const std::string& reason);
// The answer to calls that a coordinator cannot serve any more because it ends. Callers try again.
grpc::Status CoordinatorEnds();
// A worker returned something before this process of the coordinator knew it: it should try again.
grpc::Status HasNotJoined();
// Whether the same call may succeed later: the coordinator was not reached, did not answer in time or
// answered TryAgain.
bool IsTransient(const grpc::Status& status);

}  // namespace tessera
