#include "coordinator/store/message_file.h"

#include <filesystem>

#include "coordinator/core/byte_codec.h"

namespace tessera {
namespace {

constexpr uint32_t kMessageVersion = 1;
constexpr uint64_t kRecordBytesMax = kReasonBytesMax + 256;
constexpr RecordFormat kMessageFormat{"TSJL", 1, 1, kRecordBytesMax};

}  // namespace

std::string EncodeMessage(const StoredMessage& message) {
  ByteWriter body;
  body.Add64(Number(message.job));
  body.Add64(message.submission);
  body.Add64(message.entry.number);
  body.Add64(static_cast<uint64_t>(message.entry.unix_time_ms));
  body.Add32(static_cast<uint32_t>(message.entry.level));
  body.AddText(message.entry.text);
  ByteWriter record;
  record.AddRecord(kMessageVersion, kMessageVersion, body.Take());
  return record.Take();
}

Result<StoredMessage> DecodeMessage(std::string_view bytes) {
  ByteReader reader(bytes);
  auto record = reader.ReadRecord(kMessageVersion);
  if (!record || !reader.at_end()) return Failed("a message record cannot be decoded");
  StoredMessage message;
  message.job = JobId{record->body.Read64()};
  message.submission = record->body.Read64();
  message.entry.number = record->body.Read64();
  message.entry.unix_time_ms = static_cast<int64_t>(record->body.Read64());
  const uint32_t level = record->body.Read32();
  message.entry.text = record->body.ReadText();
  if (!record->IsReadBy(kMessageVersion) || level > static_cast<uint32_t>(kMessageLevelLast))
    return Failed("a message record cannot be decoded");
  message.entry.level = static_cast<MessageLevel>(level);
  return message;
}

Result<MessageFile> MessageFile::Open(const std::string& path,
                                      const std::function<void(StoredMessage)>& visit) {
  if (!std::filesystem::exists(path)) return Create(path);
  const auto read = [&](std::string_view payload, uint32_t) -> Result<void> {
    auto message = DecodeMessage(payload);
    if (!message) return message.error();
    visit(std::move(*message));
    return {};
  };
  auto log = RecordLog::Open(path, kMessageFormat, read, "a new file is started");
  if (!log) return log.error();
  return MessageFile(std::move(*log));
}

Result<MessageFile> MessageFile::Create(const std::string& path) {
  auto log = RecordLog::Create(path, kMessageFormat);
  if (!log) return log.error();
  return MessageFile(std::move(*log));
}

void MessageFile::Append(const StoredMessage& message) {
  log_->Append(EncodeMessage(message));
}

}  // namespace tessera
