#include <cstring>
#include <vector>

#include "coordinator/core/fact.h"
#include "coordinator/store/crc32c.h"
#include "coordinator/store/file_journal.h"
#include "coordinator/store/node_log.h"
#include "renderer/film/merger.h"
#include "renderer/util/check.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/small_frame.h"
#include "tests/fuzz/targets.h"

namespace tessera {
namespace {

void Overwrite(std::string& bytes, size_t at, uint32_t value) {
  std::memcpy(&bytes[at], &value, sizeof value);
}

// A record log (record_log.h) with correct checksums, which no fuzzer guesses.
std::string WithChecksums(std::string_view log) {
  constexpr size_t kFileHeaderSize = 8, kHeaderSize = 20, kPayloadSumAt = 12, kHeaderSumAt = 16;
  std::string repaired(log);
  for (size_t at = kFileHeaderSize; at + kHeaderSize <= log.size();) {
    uint32_t length = 0;
    std::memcpy(&length, &log[at], sizeof length);
    if (length > log.size() - at - kHeaderSize) break;
    Overwrite(repaired, at + kPayloadSumAt, Crc32c(log.substr(at + kHeaderSize, length)));
    Overwrite(repaired, at + kHeaderSumAt, Crc32c(std::string_view(repaired).substr(at, kHeaderSumAt)));
    at += kHeaderSize + length;
  }
  return repaired;
}

// Opens the journal, which cuts off a torn end, and checks that it then holds the same facts and one more.
bool TryJournal(const MemoryFile& file, std::string_view bytes) {
  file.Fill(bytes);
  std::vector<std::string> facts, again;
  auto journal = FileJournal::Open(file.path(), [&](const Fact& fact) { facts.push_back(EncodeFact(fact)); });
  if (!journal) {
    TESSERA_CHECK(!journal.error().message.empty());
    return false;
  }
  const Fact added = JobsForgotten{JobId{7}};
  (*journal)->Append(added);
  TESSERA_CHECK((*journal)->Sync().has_value());
  facts.push_back(EncodeFact(added));
  const auto reopened =
      FileJournal::Open(file.path(), [&](const Fact& fact) { again.push_back(EncodeFact(fact)); });
  TESSERA_CHECK(reopened.has_value() && again == facts);
  return true;
}

// The bytes of a node. Values may be NaN, which is not equal to itself.
std::string TextOf(const TileNode& node) {
  std::string text;
  for (const uint32_t number : {node.tile, node.range.begin, node.range.size})
    text += std::to_string(number) + ' ';
  return text.append(reinterpret_cast<const char*>(node.sums->data()), node.sums->size() * sizeof(float));
}

// Opens the spool file, which cuts off a torn end, checks that it then holds the same nodes, and merges them.
bool TrySpool(const MemoryFile& file, std::string_view bytes) {
  file.Fill(bytes);
  std::vector<std::string> nodes, again;
  Merger merger(SmallFrame());
  const auto merge = [&](TileNode node) {
    nodes.push_back(TextOf(node));
    const auto merged = merger.Add(std::move(node));
    if (!merged) TESSERA_CHECK(!merged.error().message.empty());
  };
  const auto log = NodeLog::Open(file.path(), merge);
  if (!log) {
    TESSERA_CHECK(!log.error().message.empty());
    return false;
  }
  const auto read = NodeLog::Read(file.path(), RecordLog::Tail::kWhole,
                                  [&](const TileNode& node) { again.push_back(TextOf(node)); });
  TESSERA_CHECK(read.has_value() && again == nodes);
  TESSERA_CHECK(merger.samples_merged() <= merger.samples_total());
  merger.Picture();
  return true;
}

// Tries the bytes as they are, and with correct checksums.
template <typename Try>
bool TryLog(std::string_view bytes, Try try_log) {
  static const MemoryFile file;
  const std::string repaired = WithChecksums(bytes);
  if (repaired != bytes) try_log(file, bytes);
  return try_log(file, repaired);
}

}  // namespace

bool FuzzFact(std::string_view bytes) {
  const Result<Fact> fact = DecodeFact(bytes);
  if (!fact) return false;
  const std::string encoded = EncodeFact(*fact);
  const Result<Fact> again = DecodeFact(encoded);
  TESSERA_CHECK(again.has_value() && EncodeFact(*again) == encoded);
  return true;
}

bool FuzzJournal(std::string_view bytes) {
  return TryLog(bytes, TryJournal);
}

bool FuzzSpool(std::string_view bytes) {
  return TryLog(bytes, TrySpool);
}

}  // namespace tessera
