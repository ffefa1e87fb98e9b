#include "coordinator/message_guard.h"

#include <fmt/format.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream.h>
#include <google/protobuf/wire_format_lite.h>
#include <grpc/byte_buffer_reader.h>
#include <grpcpp/impl/codegen/proto_utils.h>

#include "renderer/text/unicode.h"
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

// Counts what the parser would allocate, and accepts nothing that the parser would refuse: such a refusal has
// no reason.
class ElementCounter {
 public:
  ElementCounter(CodedInputStream& input, size_t elements_max) : input_(input), left_(elements_max) {}
  bool is_exceeded() const { return is_exceeded_; }
  bool has_bad_text() const { return has_bad_text_; }

  // Counts the next `size` bytes. Returns false if they are malformed or the limit is exceeded.
  bool Count(const Descriptor& type, int size, int depth) {
    if (depth > kDepthMax) return false;
    const auto outer = input_.PushLimit(size);
    while (input_.BytesUntilLimit() > 0) {
      uint64_t tag = 0;
      if (!ReadShort(tag) || !CountField(type, static_cast<uint32_t>(tag), depth)) return false;
    }
    input_.PopLimit(outer);
    return true;
  }

 private:
  bool CountField(const Descriptor& type, uint32_t tag, int depth) {
    const int number = WireFormatLite::GetTagFieldNumber(tag);
    if (number == 0) return false;
    const FieldDescriptor* const field = type.FindFieldByNumber(number);
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
    uint64_t long_size = 0;
    if (!ReadShort(long_size) || long_size > static_cast<uint64_t>(input_.BytesUntilLimit())) return false;
    const int size = static_cast<int>(long_size);
    if (field == nullptr) return input_.Skip(size);
    if (field->type() == FieldDescriptor::TYPE_MESSAGE) return Count(*field->message_type(), size, depth + 1);
    if (field->type() == FieldDescriptor::TYPE_STRING) return CheckText(size);
    return field->is_packable() ? CountPacked(*field, size) : input_.Skip(size);
  }
  bool CountPacked(const FieldDescriptor& field, int size) {
    if (!Take(static_cast<size_t>(size) / kPackedBytes)) return false;
    switch (WireFormatLite::WireTypeForFieldType(static_cast<WireFormatLite::FieldType>(field.type()))) {
      case WireFormatLite::WIRETYPE_FIXED64: return size % 8 == 0 && input_.Skip(size);
      case WireFormatLite::WIRETYPE_FIXED32: return size % 4 == 0 && input_.Skip(size);
      default: break;
    }
    const auto outer = input_.PushLimit(size);
    uint64_t ignored = 0;
    while (input_.BytesUntilLimit() > 0) {
      if (!input_.ReadVarint64(&ignored)) return false;
    }
    input_.PopLimit(outer);
    return true;
  }
  // A tag or a size, for which the parser takes no more than 5 bytes.
  bool ReadShort(uint64_t& value) {
    constexpr int kBytesMax = 5;
    const int start = input_.CurrentPosition();
    return input_.ReadVarint64(&value) && input_.CurrentPosition() - start <= kBytesMax;
  }
  // The parser prints an error about each text that is not UTF-8, and the caller would not learn why it
  // fails.
  bool CheckText(int size) {
    std::string text;
    if (!input_.ReadString(&text, size)) return false;
    has_bad_text_ = !IsUtf8(text);
    return !has_bad_text_;
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
  bool has_bad_text_ = false;
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
  if (counter.Count(type, static_cast<int>(slices.length), 0)) return grpc::Status::OK;
  if (counter.is_exceeded())
    return TooLarge(fmt::format("it has more than {} elements", limits.elements_max));
  return BadMessage(counter.has_bad_text() ? "it contains text that is not UTF-8" : "it is malformed");
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
