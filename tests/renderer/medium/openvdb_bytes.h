// OpenVDB files with one grid of one leaf, written byte by byte.
#pragma once

#include <immintrin.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace tessera {

struct OpenVdbOptions {
  bool is_zipped = false, is_half = false;
  bool stores_active_alone = false;
  std::string map = "UniformScaleMap", grid_class = "fog volume";
  uint32_t version = 224;
  // Active cubes of 4096 x 4096 x 4096 voxels of the value 1 that the root has, all at (0, 0, 0).
  uint32_t root_tiles = 0;
};

// The voxels (x, y, z) of 0 to 7 at 0.5 (x, y, z) have the values of `values`, [64 x + 8 y + z]; those that
// are not zero are active.
class OpenVdbWriter {
 public:
  OpenVdbWriter(const std::vector<float>& values, const OpenVdbOptions& options) : options_(options) {
    Write(std::string(" BDV\0\0\0\0", 8));
    Write(options.version);
    Write(uint64_t{10});
    Write(uint8_t{1});
    Write(std::string(36, 'u'));
    Write(uint32_t{0});  // metadata
    Write(uint32_t{1});  // grids
    WriteText("density");
    WriteText(options.is_half ? "Tree_float_5_4_3_HalfFloat" : "Tree_float_5_4_3");
    WriteText("");
    const uint64_t places_at = bytes.size();
    for (const uint64_t place : {places_at + 24, places_at + 24, uint64_t{0}}) Write(place);
    Write(uint32_t{(options.is_zipped ? 1u : 0u) | (options.stores_active_alone ? 2u : 0u)});
    Write(uint32_t{1});
    WriteText("class");
    WriteText("string");
    WriteText(options.grid_class);
    WriteText(options.map);
    for (int i = 0; i < 15; ++i) Write(0.5);
    Write(uint32_t{1});  // buffers
    Write(0.0f);         // background
    Write(options.root_tiles);
    Write(uint32_t{1});  // children of the root
    for (uint32_t tile = 0; tile < options.root_tiles; ++tile) {
      Write(std::string(3 * sizeof(int32_t), '\0'));
      Write(1.0f);
      Write(uint8_t{1});
    }
    for (int i = 0; i < 3; ++i) Write(uint32_t{0});
    for (const size_t children : {size_t{32768}, size_t{4096}}) {
      std::string mask(children / 8, '\0');
      Write('\1' + mask.substr(1));
      Write(mask);
      WriteValues(std::vector<float>(children), mask);
    }
    std::string active(64, '\0');
    for (size_t i = 0; i < 512; ++i) active[i / 8] |= static_cast<char>((values[i] != 0 ? 1 : 0) << i % 8);
    Write(active);
    Write(active);
    WriteValues(values, active);
    const uint64_t end = bytes.size();
    std::memcpy(bytes.data() + places_at + 16, &end, sizeof end);
  }

  std::string bytes;

 private:
  template <typename T>
  void Write(T value) {
    if constexpr (std::is_same_v<T, std::string>)
      bytes += value;
    else
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void WriteText(const std::string& text) {
    Write(static_cast<uint32_t>(text.size()));
    Write(text);
  }
  void WriteValues(const std::vector<float>& values, const std::string& active) {
    Write(uint8_t(options_.stores_active_alone ? 0 : 6));
    std::string stored;
    for (size_t i = 0; i < values.size(); ++i) {
      if (options_.stores_active_alone && (active[i / 8] >> i % 8 & 1) == 0) continue;
      const uint16_t half = _cvtss_sh(values[i], 0);
      stored.append(
          options_.is_half ? reinterpret_cast<const char*>(&half) : reinterpret_cast<const char*>(&values[i]),
          options_.is_half ? 2 : 4);
    }
    if (options_.is_half && stored.empty()) return;
    if (!options_.is_zipped) return Write(stored);
    std::string packed(compressBound(stored.size()), '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(stored.data()),
             stored.size());
    const bool helps = size < stored.size();
    Write(helps ? static_cast<int64_t>(size) : -static_cast<int64_t>(stored.size()));
    Write(helps ? packed.substr(0, size) : stored);
  }

  OpenVdbOptions options_;
};

}  // namespace tessera
