// Messages to a coordinator as no honest client sends them.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/security/credentials.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/sanitizers.h"

namespace tessera {

// What a coordinator may take at most, whatever it is sent.
constexpr uint64_t kPeakBytesMax = MemoryBound(uint64_t{512} << 20);

// The largest memory that a process has had resident.
inline uint64_t PeakBytes(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  std::string word;
  while (status >> word) {
    uint64_t kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes << 10;
  }
  return 0;
}

class HostileClient {
 public:
  explicit HostileClient(const std::string& address) {
    grpc::ChannelArguments arguments;
    arguments.SetMaxSendMessageSize(-1);
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    channel_ = grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
  }

  // A message of `count` copies of `piece`, of which only one is in the memory of this process.
  static grpc::ByteBuffer Repeated(const std::string& piece, size_t count) {
    const std::vector<grpc::Slice> slices(count, grpc::Slice(piece));
    return {slices.data(), slices.size()};
  }
  // The bytes before a field of this length.
  static std::string FieldHead(int number, uint64_t length) {
    std::string head(1, static_cast<char>(number << 3 | 2));
    for (; length >= 0x80; length >>= 7) head += static_cast<char>(length | 0x80);
    return head + static_cast<char>(length);
  }
  // Makes one call "Service/Method" with one message and returns its status.
  grpc::Status Send(const std::string& method, const grpc::ByteBuffer& message,
                    grpc_compression_algorithm compression = GRPC_COMPRESS_NONE) {
    grpc::CompletionQueue queue;
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kSlowdown * std::chrono::seconds(60));
    context.set_compression_algorithm(compression);
    grpc::GenericStub stub(channel_);
    const auto call = stub.PrepareUnaryCall(&context, "/tessera.proto." + method, message, &queue);
    call->StartCall();
    grpc::ByteBuffer answer;
    grpc::Status status;
    call->Finish(&answer, &status, nullptr);
    void* tag = nullptr;
    bool ok = false;
    queue.Next(&tag, &ok);
    return status;
  }

 private:
  std::shared_ptr<grpc::Channel> channel_;
};

}  // namespace tessera
