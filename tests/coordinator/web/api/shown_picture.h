// A reader of the picture stream, as the page is one, which checks every length.
#pragma once

#include <gtest/gtest.h>
#include <half.h>

#include <cstring>
#include <string>
#include <vector>

#include "coordinator/web/api/picture_board.h"

namespace tessera {

struct ShownPicture {
  PictureShape shape;
  std::vector<float> values;
  uint64_t samples_done = 0;
  bool is_finished = false;
  std::string problem;
  int frames = 0;

  // Everything that there is. Returns the number of bytes.
  size_t Receive(const PictureBoard& board) { return ReceiveOnce(board, SIZE_MAX); }
  size_t ReceiveOnce(const PictureBoard& board, size_t bytes_max) {
    std::vector<BodyStream::Part> parts;
    const size_t bytes = board.Collect(bytes_max, cursor, parts);
    for (const auto& part : parts) Read(*part);
    return bytes;
  }
  // Whole messages. Returns how many bytes they have.
  size_t Read(const std::string& bytes) {
    size_t at = 0;
    while (bytes.size() - at >= 12) {
      EXPECT_EQ(bytes.substr(at, 5), std::string("TPIX\x01"));
      const uint32_t size = Number(bytes, at + 8);
      if (bytes.size() - at - 12 < size) break;
      ReadMessage(bytes[at + 5], bytes.substr(at + 12, size));
      at += 12 + size;
    }
    return at;
  }

  PictureBoard::Cursor cursor;

 private:
  static uint32_t Number(const std::string& bytes, size_t at) {
    uint32_t number = 0;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
  }
  void ReadMessage(char kind, const std::string& payload) {
    const auto number = [&](size_t i) { return static_cast<int>(Number(payload, 4 * i)); };
    if (kind == 1) {
      ASSERT_EQ(payload.size(), 32u);
      ++frames;
      shape.width = number(0);
      shape.height = number(1);
      shape.step = number(2);
      shape.crop = {number(3), number(4), 0, 0};
      shape.type = payload[28] == 1 ? ExrType::kHalf : ExrType::kFloat;
      shape.channels = static_cast<unsigned char>(payload[29]);
      values.assign(static_cast<size_t>(shape.width * shape.height) * shape.channels, 0.0f);
    } else if (kind == 2) {
      const int x0 = number(0), y0 = number(1), width = number(2), height = number(3);
      ASSERT_LE(x0 + width, shape.width);
      ASSERT_LE(y0 + height, shape.height);
      const auto channels = static_cast<int>(shape.channels);
      ASSERT_EQ(payload.size(), 16 + static_cast<size_t>(width * height * channels) * shape.ValueBytes());
      const char* next = payload.data() + 16;
      for (int y = y0; y < y0 + height; ++y) {
        for (int i = 0; i < channels * width; ++i, next += shape.ValueBytes())
          values[static_cast<size_t>(channels * (y * shape.width + x0) + i)] = Value(next);
      }
    } else if (kind == 4) {
      problem = payload;
    } else {
      ASSERT_EQ(kind, 3);
      ASSERT_EQ(payload.size(), 24u);
      std::memcpy(&samples_done, payload.data(), sizeof samples_done);
      is_finished = payload[16] != 0;
    }
  }
  float Value(const char* bytes) const {
    if (shape.type == ExrType::kFloat) {
      float value = 0;
      std::memcpy(&value, bytes, sizeof value);
      return value;
    }
    half value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }
};

}  // namespace tessera
