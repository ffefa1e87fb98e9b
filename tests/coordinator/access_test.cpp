// Every call of every service is checked by its own rule before anything else happens.
#include "coordinator/access.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>

#include <mutex>
#include <set>

#include "proto/access.pb.h"
#include "tests/coordinator/services_fixture.h"

namespace tessera {
namespace {

// "SERVICE.METHOD" of everything that the .proto files define.
std::vector<const google::protobuf::MethodDescriptor*> AllMethods() {
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

std::string NameOf(const google::protobuf::MethodDescriptor& method) {
  return method.service()->name() + "." + method.name();
}

TEST(CallRules, EveryCallHasOneRuleAndEveryRuleACall) {
  std::multiset<std::string> methods, rules;
  for (const auto* method : AllMethods()) methods.insert(NameOf(*method));
  for (const CallRule& rule : kCallRules) rules.insert(std::string(rule.method));
  EXPECT_EQ(rules, methods);
}

// A coordinator whose policy refuses everything and notes what it was asked.
class ClosedServices : public Services {
 protected:
  ClosedServices()
      : Services([this](const Principal& caller, const CallRule& rule) -> Result<void> {
          const std::lock_guard lock(mutex_);
          asked_ = std::string(rule.method);
          peer_ = caller.peer;
          return BadInput("no entry");
        }) {}

  // Makes a call with an empty message and returns its status.
  grpc::Status CallEmpty(const google::protobuf::MethodDescriptor& method) {
    grpc::CompletionQueue queue;
    grpc::ClientContext context;
    SetDeadline(context, kPatience);
    grpc::GenericStub stub(channel);
    const std::string path = "/" + method.service()->full_name() + "/" + method.name();
    const auto stream = stub.PrepareCall(&context, path, &queue);
    grpc::ByteBuffer empty, answer;
    grpc::Status status;
    void* tag = nullptr;
    bool ok = false;
    stream->StartCall(nullptr);
    queue.Next(&tag, &ok);
    const grpc::Slice nothing;
    empty = grpc::ByteBuffer(&nothing, 1);
    stream->WriteLast(empty, {}, nullptr);
    queue.Next(&tag, &ok);
    stream->Finish(&status, nullptr);
    queue.Next(&tag, &ok);
    return status;
  }

  std::mutex mutex_;
  std::string asked_, peer_;
};

TEST_F(ClosedServices, EveryCallIsCheckedByItsOwnRuleBeforeItIsServed) {
  for (const auto* method : AllMethods()) {
    const grpc::Status status = CallEmpty(*method);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED) << NameOf(*method);
    EXPECT_EQ(status.error_message(), "no entry") << NameOf(*method);
    const std::lock_guard lock(mutex_);
    EXPECT_EQ(asked_, NameOf(*method));
    EXPECT_THAT(peer_, testing::StartsWith("unix:"));
  }
}

}  // namespace
}  // namespace tessera
