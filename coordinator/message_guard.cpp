#include "coordinator/message_guard.h"

#include <fmt/format.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream.h>
#include <google/protobuf/wire_format_lite.h>
#include <grpc/byte_buffer_reader.h>
#include <grpcpp/impl/codegen/proto_utils.h>

#include "renderer/util/check.h"

namespace tessera {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedInputStream;

constexpr int kDepthMax = 32;
// Of a packed field: bytes that count as an element, since they make at most this many numbers.
constexpr uint32_t kPackedBytes = 8;

// Reads the slices of a byte buffer without copying them.
class SliceStream final : public google::protobuf::io::ZeroCopyInputStream {
 public:
  explicit SliceStream(const grpc_slice_buffer& slices) : slices_(slices) {}
  bool Next(const void** data, int* size) override {
    if (next_ == slices_.count) return false;
    const grpc_slice& slice = slices_.slices[next_++];
    *data = GRPC_SLICE_START_PTR(slice) + skipped_;
    *size = static_cast<int>(GRPC_SLICE_LENGTH(slice) - skipped_);
    skipped_ = 0;
    read_ += *size;
    return true;
  }
  void BackUp(int count) override {
    --next_;
    skipped_ = GRPC_SLICE_LENGTH(slices_.slices[next_]) - static_cast<size_t>(count);
    read_ -= count;
  }
  bool Skip(int count) override {
    const void* data = nullptr;
    int size = 0;
    while (count > 0 && Next(&data, &size)) {
      if (size > count) BackUp(size - count);
      count -= std::min(size, count);
    }
    return count == 0;
  }
  int64_t ByteCount() const override { return read_; }

 private:
  const grpc_slice_buffer& slices_;
  size_t next_ = 0, skipped_ = 0;
  int64_t read_ = 0;
};

// Counts what a parser would allocate. Walks through the fields as the parser does.
class ElementCounter {
 public:
  ElementCounter(CodedInputStream& input, size_t elements_max) : input_(input), left_(elements_max) {}
  bool is_exceeded() const { return is_exceeded_; }

  // Returns false if the bytes are malformed or the limit is exceeded.
  bool Count(const Descriptor& type, int depth) {
    if (depth > kDepthMax) return false;
    while (const uint32_t tag = input_.ReadTag()) {
      const FieldDescriptor* const field = type.FindFieldByNumber(WireFormatLite::GetTagFieldNumber(tag));
      if (!CountField(field, tag, depth)) return false;
    }
    return input_.ConsumedEntireMessage();
  }

 private:
  bool CountField(const FieldDescriptor* field, uint32_t tag, int depth) {
    uint64_t ignored = 0;
    // A known single number takes no memory of its own; an unknown one is kept.
    const bool is_plain = field != nullptr && !field->is_repeated();
    switch (WireFormatLite::GetTagWireType(tag)) {
      case WireFormatLite::WIRETYPE_VARINT: return Take(is_plain ? 0 : 1) && input_.ReadVarint64(&ignored);
      case WireFormatLite::WIRETYPE_FIXED64: return Take(is_plain ? 0 : 1) && input_.Skip(8);
      case WireFormatLite::WIRETYPE_FIXED32: return Take(is_plain ? 0 : 1) && input_.Skip(4);
      case WireFormatLite::WIRETYPE_LENGTH_DELIMITED: return Take(1) && CountBytes(field, depth);
      default: return false;  // groups, which no message has
    }
  }
  bool CountBytes(const FieldDescriptor* field, int depth) {
    uint32_t size = 0;
    if (!input_.ReadVarint32(&size) || size > static_cast<uint32_t>(INT32_MAX)) return false;
    if (field == nullptr || field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) {
      const bool is_packed = field != nullptr && field->is_packable();
      return Take(is_packed ? size / kPackedBytes : 0) && input_.Skip(static_cast<int>(size));
    }
    const auto outer = input_.PushLimit(static_cast<int>(size));
    if (!Count(*field->message_type(), depth + 1)) return false;
    input_.PopLimit(outer);
    return true;
  }
  bool Take(size_t elements) {
    is_exceeded_ = is_exceeded_ || elements > left_;
    if (is_exceeded_) return false;
    left_ -= elements;
    return true;
  }

  CodedInputStream& input_;
  size_t left_;
  bool is_exceeded_ = false;
};

grpc::Status BadMessage(const std::string& what) {
  return {grpc::StatusCode::INVALID_ARGUMENT, "message refused: " + what};
}

grpc::Status TooLarge(const std::string& what) {
  return {grpc::StatusCode::RESOURCE_EXHAUSTED, "message refused: " + what};
}

}  // namespace

grpc::Status CheckMessage(const grpc_byte_buffer& bytes, const Descriptor& type,
                          const MessageLimits& limits) {
  if (bytes.data.raw.compression != GRPC_COMPRESS_NONE) return BadMessage("compression is not supported");
  const grpc_slice_buffer& slices = bytes.data.raw.slice_buffer;
  if (slices.length > limits.bytes_max)
    return TooLarge(fmt::format("it has {} bytes (limit {})", slices.length, limits.bytes_max));
  SliceStream stream(slices);
  CodedInputStream input(&stream);
  ElementCounter counter(input, limits.elements_max);
  if (counter.Count(type, 0)) return grpc::Status::OK;
  if (counter.is_exceeded())
    return TooLarge(fmt::format("it has more than {} elements", limits.elements_max));
  return BadMessage("it is malformed");
}

grpc::Status ParseMessage(grpc::ByteBuffer& bytes, const MessageLimits& limits,
                          google::protobuf::Message& message) {
  // The slices of the buffer are shared, not copied.
  std::vector<grpc::Slice> slices;
  if (!bytes.Dump(&slices).ok()) return BadMessage("it is malformed");
  std::vector<grpc_slice> shared;
  shared.reserve(slices.size());
  for (const grpc::Slice& slice : slices) shared.push_back(slice.c_slice());
  grpc_byte_buffer* const raw = grpc_raw_byte_buffer_create(shared.data(), shared.size());
  for (const grpc_slice& slice : shared) grpc_slice_unref(slice);
  const grpc::Status checked = CheckMessage(*raw, *message.GetDescriptor(), limits);
  grpc_byte_buffer_destroy(raw);
  if (!checked.ok()) return checked;
  slices.clear();
  return grpc::SerializationTraits<google::protobuf::Message>::Deserialize(&bytes, &message);
}

int MethodIndex(const CallRule& rule) {
  const auto* const pool = google::protobuf::DescriptorPool::generated_pool();
  const auto* const method = pool->FindMethodByName("tessera.proto." + std::string(rule.method));
  TESSERA_CHECK(method != nullptr);
  return method->index();
}

}  // namespace tessera
