#include "renderer/image/qoi.h"

#include <array>

#include <fmt/format.h>

#include "renderer/image/image_limits.h"

namespace tessera {
namespace {

constexpr size_t kHeaderSize = 14;

struct Pixel {
  uint8_t r = 0, g = 0, b = 0, a = 0;
};

// The stream of chunks after the header; yields one pixel at a time.
class Decoder {
 public:
  explicit Decoder(std::string_view chunks) : chunks_(chunks) {}

  // Returns false at the end of the bytes.
  bool Next(Pixel& pixel) {
    if (run_ > 0) {
      --run_;
    } else if (!ReadChunk()) {
      return false;
    }
    pixel = current_;
    return true;
  }

 private:
  bool Read(uint8_t& byte) {
    if (position_ >= chunks_.size()) return false;
    byte = static_cast<uint8_t>(chunks_[position_++]);
    return true;
  }

  bool ReadChunk() {
    uint8_t tag;
    if (!Read(tag)) return false;
    if (tag == 0xfe) {
      if (!(Read(current_.r) && Read(current_.g) && Read(current_.b))) return false;
    } else if (tag == 0xff) {
      if (!(Read(current_.r) && Read(current_.g) && Read(current_.b) && Read(current_.a))) return false;
    } else if (!ReadShort(tag)) {
      return false;
    }
    seen_[(current_.r * 3 + current_.g * 5 + current_.b * 7 + current_.a * 11) % 64] = current_;
    return true;
  }

  // A chunk whose kind is in the two upper bits of its first byte.
  bool ReadShort(uint8_t tag) {
    const uint8_t low = tag & 0x3f;
    switch (tag >> 6) {
      case 0: current_ = seen_[low]; return true;
      case 1: Add((low >> 4) - 2, ((low >> 2) & 3) - 2, (low & 3) - 2); return true;
      case 2: {
        uint8_t next;
        if (!Read(next)) return false;
        const int green = low - 32;
        Add(green - 8 + (next >> 4), green, green - 8 + (next & 15));
        return true;
      }
      default: run_ = low; return true;  // the first pixel of the run is this one
    }
  }

  void Add(int r, int g, int b) {
    current_.r = static_cast<uint8_t>(current_.r + r);
    current_.g = static_cast<uint8_t>(current_.g + g);
    current_.b = static_cast<uint8_t>(current_.b + b);
  }

  std::string_view chunks_;
  size_t position_ = 0;
  int run_ = 0;
  Pixel current_{0, 0, 0, 255};
  std::array<Pixel, 64> seen_{};
};

uint32_t BigEndian(const std::string& bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
  return value;
}

}  // namespace

Result<Image> DecodeQoi(const std::string& bytes, const std::string& name,
                        std::optional<ColorEncoding> encoding) {
  if (bytes.size() < kHeaderSize)
    return BadInput(fmt::format("{}: damaged picture: it ends in its header", name));
  Image image;
  const int channels = static_cast<uint8_t>(bytes[12]);
  const int color_space = static_cast<uint8_t>(bytes[13]);
  if ((channels != 3 && channels != 4) || color_space > 1) {
    return BadInput(fmt::format("{}: damaged picture: its header says {} channels and colour space {}", name,
                                channels, color_space));
  }
  const Result<void> size =
      CheckImageSize(name, BigEndian(bytes, 4), BigEndian(bytes, 8), channels, 1, bytes.size());
  if (!size) return size.error();
  image.width = static_cast<int>(BigEndian(bytes, 4));
  image.height = static_cast<int>(BigEndian(bytes, 8));
  image.channels = channels;
  image.format = PixelFormat::kUint8;
  const ColorEncoding stored{color_space == 0 ? ColorEncoding::Kind::kSrgb : ColorEncoding::Kind::kLinear, 1};
  image.encoding = encoding.value_or(stored);
  image.channel_names = {"R", "G", "B"};
  if (channels == 4) image.channel_names.push_back("A");
  const size_t pixels = static_cast<size_t>(image.width) * image.height;
  image.bytes.resize(pixels * channels);
  Decoder decoder(std::string_view(bytes).substr(kHeaderSize));
  for (size_t i = 0; i < pixels; ++i) {
    Pixel pixel;
    if (!decoder.Next(pixel)) {
      return BadInput(fmt::format("{}: damaged picture: it ends after {} of {} pixels", name, i, pixels));
    }
    const std::array<uint8_t, 4> values{pixel.r, pixel.g, pixel.b, pixel.a};
    for (int c = 0; c < channels; ++c) image.bytes[i * channels + c] = values[c];
  }
  return image;
}

}  // namespace tessera
