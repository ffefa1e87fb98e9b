#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/message.h>

#include <memory>
#include <optional>
#include <vector>

#include "coordinator/access.h"
#include "coordinator/message_guard.h"
#include "proto/blobs.pb.h"
#include "proto/jobs.pb.h"
#include "proto/terms.pb.h"
#include "proto/wire/convert.h"
#include "proto/work.pb.h"
#include "renderer/film/radiance_tile.h"
#include "renderer/util/check.h"
#include "tests/fuzz/targets.h"

namespace tessera {
namespace {

using google::protobuf::DynamicCastToGenerated;
using google::protobuf::Message;

// The name in the first line of the input; the rest follows.
std::optional<std::string> TakeName(std::string_view& bytes) {
  const size_t end = bytes.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string name(bytes.substr(0, end));
  bytes.remove_prefix(end + 1);
  return name;
}

// An empty message of the input of a call; null if there is no such call.
std::unique_ptr<Message> RequestOfCall(const std::string& method) {
  for (const CallRule& rule : kCallRules) {
    if (rule.method != method) continue;
    const auto* const descriptor =
        google::protobuf::DescriptorPool::generated_pool()->FindMethodByName("tessera.proto." + method);
    TESSERA_CHECK(descriptor != nullptr);
    const auto* const type = descriptor->input_type();
    return std::unique_ptr<Message>(
        google::protobuf::MessageFactory::generated_factory()->GetPrototype(type)->New());
  }
  return nullptr;
}

// The bytes in slices of different sizes, as the network delivers them.
grpc::ByteBuffer InSlices(std::string_view bytes) {
  std::vector<grpc::Slice> slices;
  for (size_t size = 1; !bytes.empty(); size = size * 5 + 1) {
    const std::string_view part = bytes.substr(0, size);
    slices.emplace_back(part.data(), part.size());
    bytes.remove_prefix(part.size());
  }
  return {slices.data(), slices.size()};
}

// Parses what the guard lets through, and checks that it takes no more memory than the limits promise.
bool ParseGuarded(std::string_view bytes, Message& message) {
  constexpr MessageLimits kLimits{16 << 10, 100};
  constexpr size_t kElementBytes = 400;
  const size_t empty_bytes = message.SpaceUsedLong();
  grpc::ByteBuffer buffer = InSlices(bytes);
  const grpc::Status parsed = ParseMessage(buffer, kLimits, message);
  if (!parsed.ok()) {
    // Only what the guard refuses has a reason: the parser accepts all that it lets through.
    TESSERA_CHECK(parsed.error_message().starts_with("message refused: "));
    return false;
  }
  TESSERA_CHECK(message.SpaceUsedLong() <=
                empty_bytes + kLimits.elements_max * kElementBytes + 2 * bytes.size());
  return true;
}

// The bytes of a message with its maps in order.
std::string Serialized(const Message& message) {
  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream out(&stream);
  out.SetSerializationDeterministic(true);
  TESSERA_CHECK(message.SerializeToCodedStream(&out));
  out.Trim();
  return bytes;
}

// What `read` returns is written to a message from which it reads the same.
template <typename T, typename Read>
bool ReadsWhatItWrites(const T& message, Read read) {
  const auto value = read(message);
  if (!value) {
    TESSERA_CHECK(!value.error().message.empty());
    return false;
  }
  T written, twice;
  Write(*value, written);
  const auto again = read(written);
  TESSERA_CHECK(again.has_value());
  Write(*again, twice);
  TESSERA_CHECK(Serialized(twice) == Serialized(written));
  return true;
}

bool ReadResults(const proto::ResultsRequest& request) {
  bool is_valid = ReadFarmId(request.farm()).has_value();
  for (const proto::UnitResult& result : request.results()) {
    is_valid &= ReadsWhatItWrites(result.unit(), ReadWorkUnit);
    ReadLeaseId(result.lease());
    TESSERA_CHECK(DecodedSize(result.tile()) >= result.tile().size());
  }
  return is_valid;
}

bool ReadFailure(const proto::FailureRequest& request) {
  const std::string reason = CleanReason(request.reason());
  TESSERA_CHECK(CleanReason(reason) == reason);
  const bool is_valid = request.has_lease() ? ReadWorkUnit(request.unit()).has_value()
                                            : ReadDigest(request.scene(), "scene").has_value();
  return is_valid && ReadFarmId(request.farm());
}

bool ReadDigests(const proto::FindMissingRequest& request) {
  bool are_valid = true;
  for (const std::string& bytes : request.digests()) are_valid &= ReadDigest(bytes, "digests").has_value();
  return are_valid;
}

// As the handler of the call reads it.
bool ReadRequest(const Message& message) {
  if (const auto* job = DynamicCastToGenerated<proto::JobSpec>(&message))
    return ReadsWhatItWrites(*job, ReadJobSpec);
  if (const auto* state = DynamicCastToGenerated<proto::WorkerState>(&message))
    return ReadsWhatItWrites(*state, ReadWorkerState);
  if (const auto* results = DynamicCastToGenerated<proto::ResultsRequest>(&message))
    return ReadResults(*results);
  if (const auto* failure = DynamicCastToGenerated<proto::FailureRequest>(&message))
    return ReadFailure(*failure);
  if (const auto* report = DynamicCastToGenerated<proto::PreparationReport>(&message))
    return ReadsWhatItWrites(*report, ReadPreparationReport);
  if (const auto* digests = DynamicCastToGenerated<proto::FindMissingRequest>(&message))
    return ReadDigests(*digests);
  if (const auto* chunk = DynamicCastToGenerated<proto::UploadChunk>(&message))
    return ReadDigest(chunk->digest(), "digest").has_value();
  if (const auto* blob = DynamicCastToGenerated<proto::DownloadRequest>(&message))
    return ReadDigest(blob->digest(), "digest").has_value();
  if (const auto* priority = DynamicCastToGenerated<proto::PriorityRequest>(&message))
    return ReadPriority(priority->priority()).has_value();
  if (const auto* workers = DynamicCastToGenerated<proto::WorkersRequest>(&message))
    TESSERA_CHECK(CleanName(CleanName(workers->which())) == CleanName(workers->which()));
  return true;
}

// The key of a scene is a digest that no fuzzer guesses.
void RepairKeys(proto::WorkerDirective& directive) {
  for (proto::SceneRequest& scene : *directive.mutable_scenes()) {
    const auto frame = ReadFrameSpec(scene.frame());
    const auto package = ReadDigest(scene.package(), "package");
    if (!frame || !package) continue;
    scene.set_scene(WriteDigest(SceneKey(*package, scene.scene_file(), scene.options(), *frame)));
  }
}

template <typename T, typename Read>
bool TryAnswer(std::string_view bytes, Read read) {
  T message;
  return message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) && read(message);
}

bool ReadDirective(proto::WorkerDirective& directive) {
  RepairKeys(directive);
  return ReadsWhatItWrites(directive, ReadWorkerDirective);
}

}  // namespace

// A request to a coordinator: the name of the call, a newline and the message.
bool FuzzRequest(std::string_view bytes) {
  const auto name = TakeName(bytes);
  const auto message = name ? RequestOfCall(*name) : nullptr;
  return message != nullptr && ParseGuarded(bytes, *message) && ReadRequest(*message);
}

// What clients and workers read of a coordinator: the name of the message, a newline and the message.
bool FuzzAnswer(std::string_view bytes) {
  const auto name = TakeName(bytes);
  if (name == "WorkerDirective") return TryAnswer<proto::WorkerDirective>(bytes, ReadDirective);
  const auto with = [](auto read) {
    return [read](const auto& message) { return ReadsWhatItWrites(message, read); };
  };
  if (name == "Lease") return TryAnswer<proto::Lease>(bytes, with(ReadLease));
  if (name == "JobStatus") return TryAnswer<proto::JobStatus>(bytes, with(ReadJobStatus));
  if (name == "FramesAnswer") return TryAnswer<proto::FramesAnswer>(bytes, with(ReadFrameStatuses));
  if (name == "JobLogAnswer") return TryAnswer<proto::JobLogAnswer>(bytes, with(ReadJobLog));
  if (name == "WorkerStatus") return TryAnswer<proto::WorkerStatus>(bytes, with(ReadWorkerStatus));
  return false;
}

}  // namespace tessera
