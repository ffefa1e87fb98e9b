#include "client/live/tev_packets.h"

#include <bit>

#include "renderer/util/check.h"

namespace tessera {
namespace {

class PacketWriter {
 public:
  explicit PacketWriter(TevPacket kind) : bytes_(4, '\0') { bytes_.push_back(static_cast<char>(kind)); }
  void AddSwitch(bool value) { bytes_.push_back(value ? 1 : 0); }
  void Add(int value) { PutNumber(bytes_.size(), static_cast<uint32_t>(value)); }
  // Up to its first zero byte.
  void AddText(const std::string& text) {
    bytes_.append(text, 0, text.find('\0'));
    bytes_.push_back('\0');
  }
  void AddTexts(const std::vector<std::string>& texts) {
    Add(static_cast<int>(texts.size()));
    for (const std::string& text : texts) AddText(text);
  }
  void AddFloats(std::span<const float> values) {
    static_assert(std::endian::native == std::endian::little);
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  std::string Take() {
    PutNumber(0, static_cast<uint32_t>(bytes_.size()));
    return std::move(bytes_);
  }

 private:
  void PutNumber(size_t at, uint32_t value) {
    if (bytes_.size() < at + 4) bytes_.resize(at + 4);
    for (size_t i = 0; i < 4; ++i) bytes_[at + i] = static_cast<char>(value >> (8 * i));
  }
  std::string bytes_;
};

}  // namespace

std::string TevCreateImage(const std::string& name, int width, int height,
                           const std::vector<std::string>& channels) {
  PacketWriter out(TevPacket::kCreateImage);
  out.AddSwitch(false);
  out.AddText(name);
  out.Add(width);
  out.Add(height);
  out.AddTexts(channels);
  return out.Take();
}

std::string TevUpdateImage(const std::string& name, const std::vector<std::string>& channels,
                           const PixelBounds& bounds, std::span<const float> values) {
  TESSERA_CHECK(values.size() == static_cast<size_t>(bounds.area()) * channels.size());
  PacketWriter out(TevPacket::kUpdateImage);
  out.AddSwitch(false);
  out.AddText(name);
  out.AddTexts(channels);
  out.Add(bounds.x0);
  out.Add(bounds.y0);
  out.Add(bounds.width());
  out.Add(bounds.height());
  out.AddFloats(values);
  return out.Take();
}

}  // namespace tessera
