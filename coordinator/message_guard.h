// Checks requests before they are parsed, because a parsed message can be a hundred times larger than its
// bytes: two bytes make an element of a repeated field. Every call of every service is registered through
// here, with the limits of its rule (access.h).
#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <grpc/byte_buffer.h>
#include <grpcpp/impl/codegen/server_callback_handlers.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>

#include <functional>
#include <memory>
#include <utility>

#include "coordinator/access.h"
#include "proto/wire/channel.h"

namespace tessera {

// OK if the bytes of a message of this type are within the limits, are not compressed, and can be parsed.
grpc::Status CheckMessage(const grpc_byte_buffer& bytes, const google::protobuf::Descriptor& type,
                          const MessageLimits& limits);

// Parses a message of a stream and releases its bytes.
grpc::Status ParseMessage(grpc::ByteBuffer& bytes, const MessageLimits& limits,
                          google::protobuf::Message& message);

// Refuses a call whose reactor would be of this type. Deletes itself when the call is over.
template <typename Reactor>
class RefusedCall final : public Reactor {
 public:
  explicit RefusedCall(const grpc::Status& status) { this->Finish(Shortened(status)); }

 private:
  void OnDone() override { delete this; }
};

// Runs a gRPC handler for requests within the limits, and refuses others with the reason.
template <typename Handler, typename Reactor, typename Request>
class GuardedHandler final : public grpc::internal::MethodHandler {
 public:
  template <typename GetReactor>
  GuardedHandler(const CallRule& rule, GetReactor get_reactor)
      : rule_(rule), handler_(std::move(get_reactor)) {}

  void* Deserialize(grpc_call* call, grpc_byte_buffer* bytes, grpc::Status* status, void** data) override {
    // Without bytes if the call was cancelled before they arrived, which the handler knows.
    const grpc::Status checked =
        bytes == nullptr ? grpc::Status::OK : CheckMessage(*bytes, *Request::descriptor(), rule_.limits);
    if (checked.ok()) return handler_.Deserialize(call, bytes, status, data);
    grpc_byte_buffer_destroy(bytes);
    // gRPC needs a request in any case.
    void* const empty = handler_.Deserialize(call, grpc_raw_byte_buffer_create(nullptr, 0), status, data);
    *status = checked;
    return empty;
  }
  void RunHandler(const HandlerParameter& parameter) override {
    if (parameter.status.ok()) return handler_.RunHandler(parameter);
    const auto refuse = [&parameter](auto&&...) { return new RefusedCall<Reactor>(parameter.status); };
    Handler(refuse).RunHandler({parameter.call, parameter.server_context, parameter.request, grpc::Status::OK,
                                parameter.internal_data, parameter.call_requester});
  }

 private:
  const CallRule& rule_;
  Handler handler_;
};

// The handler of a unary call that `serve` serves.
template <typename Request, typename Answer>
grpc::internal::MethodHandler* GuardedUnary(
    const CallRule& rule,
    std::function<grpc::ServerUnaryReactor*(grpc::CallbackServerContext*, const Request*, Answer*)> serve) {
  using Handler = grpc::internal::CallbackUnaryHandler<Request, Answer>;
  return new GuardedHandler<Handler, grpc::ServerUnaryReactor, Request>(rule, std::move(serve));
}

// The handler of a unary call that `method` of the service serves.
template <typename Service, typename Request, typename Answer>
grpc::internal::MethodHandler* GuardedMethod(
    Service* service, const CallRule& rule,
    grpc::ServerUnaryReactor* (Service::*method)(grpc::CallbackServerContext*, const Request*, Answer*)) {
  return GuardedUnary<Request, Answer>(rule, std::bind_front(method, service));
}

// The handler of a call with a stream of answers.
template <typename Service, typename Request, typename Answer>
grpc::internal::MethodHandler* GuardedMethod(
    Service* service, const CallRule& rule,
    grpc::ServerWriteReactor<Answer>* (Service::*method)(grpc::CallbackServerContext*, const Request*)) {
  using Handler = grpc::internal::CallbackServerStreamingHandler<Request, Answer>;
  return new GuardedHandler<Handler, grpc::ServerWriteReactor<Answer>, Request>(
      rule, [=](grpc::CallbackServerContext* context, const Request* request) {
        return (service->*method)(context, request);
      });
}

// The handler of a call with a stream of requests. It receives their bytes, for ParseMessage.
template <typename Service, typename Answer>
grpc::internal::MethodHandler* GuardedMethod(
    Service* service, const CallRule&,
    grpc::ServerReadReactor<grpc::ByteBuffer>* (Service::*method)(grpc::CallbackServerContext*, Answer*)) {
  return new grpc::internal::CallbackClientStreamingHandler<grpc::ByteBuffer, Answer>(
      [=](grpc::CallbackServerContext* context, Answer* answer) {
        return (service->*method)(context, answer);
      });
}

// The index of a call in its service, as the .proto file orders them.
int MethodIndex(const CallRule& rule);

}  // namespace tessera
