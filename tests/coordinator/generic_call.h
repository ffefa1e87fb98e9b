// Calls of the services as their .proto files describe them.
#pragma once

#include <google/protobuf/descriptor.h>
#include <grpcpp/channel.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>

#include <string>
#include <vector>

#include "proto/access.pb.h"
#include "proto/blobs.pb.h"
#include "proto/jobs.pb.h"
#include "proto/wire/channel.h"
#include "proto/work.pb.h"

namespace tessera {

inline std::vector<const google::protobuf::MethodDescriptor*> AllMethods() {
  std::vector<const google::protobuf::MethodDescriptor*> methods;
  for (const auto* file :
       {proto::JobSpec::descriptor()->file(), proto::WorkerState::descriptor()->file(),
        proto::UploadChunk::descriptor()->file(), proto::JoinRequest::descriptor()->file()}) {
    for (int i = 0; i < file->service_count(); ++i) {
      for (int j = 0; j < file->service(i)->method_count(); ++j)
        methods.push_back(file->service(i)->method(j));
    }
  }
  return methods;
}

// "SERVICE.METHOD"
inline std::string NameOf(const google::protobuf::MethodDescriptor& method) {
  return method.service()->name() + "." + method.name();
}

// Sends the messages and returns the status of the call, or OK as soon as there is an answer.
inline grpc::Status MakeCall(grpc::Channel& channel, const google::protobuf::MethodDescriptor& method,
                             const std::vector<std::string>& messages) {
  grpc::CompletionQueue queue;
  grpc::ClientContext context;
  SetDeadline(context, std::chrono::seconds(20));
  const std::shared_ptr<grpc::Channel> borrowed(&channel, [](grpc::Channel*) {});
  grpc::GenericStub stub(borrowed);
  const auto stream =
      stub.PrepareCall(&context, "/" + method.service()->full_name() + "/" + method.name(), &queue);
  const auto wait = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    queue.Next(&tag, &ok);
    return ok;
  };
  stream->StartCall(nullptr);
  bool goes_on = wait();
  for (size_t i = 0; i < messages.size() && goes_on; ++i) {
    const grpc::Slice bytes(messages[i]);
    const grpc::ByteBuffer message(&bytes, 1);
    if (i + 1 == messages.size()) {
      stream->WriteLast(message, {}, nullptr);
    } else {
      stream->Write(message, nullptr);
    }
    goes_on = wait();
  }
  grpc::ByteBuffer answer;
  stream->Read(&answer, nullptr);
  if (wait()) {
    context.TryCancel();
    grpc::Status ignored;
    stream->Finish(&ignored, nullptr);
    wait();
    return grpc::Status::OK;
  }
  grpc::Status status;
  stream->Finish(&status, nullptr);
  wait();
  return status;
}

}  // namespace tessera
