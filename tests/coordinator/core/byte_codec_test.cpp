#include "coordinator/core/byte_codec.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

std::string Record(uint32_t version, uint32_t readable_by, std::string_view body) {
  ByteWriter out;
  out.AddRecord(version, readable_by, body);
  return out.Take();
}

// A reader that knows versions 1 and 2: two numbers, of which version 1 has the first.
std::optional<std::pair<uint32_t, uint32_t>> ReadPair(std::string_view bytes) {
  ByteReader in(bytes);
  auto record = in.ReadRecord(2);
  if (!record) return std::nullopt;
  std::pair<uint32_t, uint32_t> numbers{record->body.Read32(), 77};
  if (record->version >= 2) numbers.second = record->body.Read32();
  if (!record->IsReadBy(2) || !in.at_end()) return std::nullopt;
  return numbers;
}

std::string Numbers(std::initializer_list<uint32_t> numbers) {
  ByteWriter out;
  for (const uint32_t number : numbers) out.Add32(number);
  return out.Take();
}

TEST(VersionedRecord, AnOlderOneGetsDefaultsAndANewerOneIsReadIfItAllows) {
  using Pair = std::pair<uint32_t, uint32_t>;
  EXPECT_EQ(ReadPair(Record(1, 1, Numbers({5}))), (Pair{5, 77}));
  EXPECT_EQ(ReadPair(Record(2, 1, Numbers({5, 6}))), (Pair{5, 6}));
  EXPECT_EQ(ReadPair(Record(3, 2, Numbers({5, 6, 7}))), (Pair{5, 6})) << "the third is ignored";
  EXPECT_EQ(ReadPair(Record(3, 3, Numbers({5, 6, 7}))), std::nullopt) << "the third must not be ignored";
}

TEST(VersionedRecord, WhatNoWriterMakesIsRefused) {
  EXPECT_EQ(ReadPair(Record(2, 2, Numbers({5}))), std::nullopt) << "too short";
  EXPECT_EQ(ReadPair(Record(2, 2, Numbers({5, 6, 7}))), std::nullopt) << "too long for its version";
  EXPECT_EQ(ReadPair(Record(0, 0, Numbers({5, 6}))), std::nullopt);
  EXPECT_EQ(ReadPair(Record(1, 2, Numbers({5}))), std::nullopt) << "not even its own readers may read it";
  const std::string bytes = Record(2, 2, Numbers({5, 6}));
  for (size_t size = 0; size < bytes.size(); ++size) EXPECT_EQ(ReadPair(bytes.substr(0, size)), std::nullopt);
}

}  // namespace
}  // namespace tessera
