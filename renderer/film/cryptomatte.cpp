#include "renderer/film/cryptomatte.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <set>

namespace tessera {
namespace {

uint32_t Scrambled(uint32_t block) {
  return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u;
}

// A JSON string. Control characters must have been replaced.
std::string Quoted(std::string_view name) {
  std::string quoted = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

}  // namespace

uint32_t MurmurHash3(std::string_view bytes) {
  uint32_t hash = 0;
  size_t i = 0;
  for (; i + 4 <= bytes.size(); i += 4) {
    uint32_t block = 0;
    std::memcpy(&block, bytes.data() + i, 4);  // little-endian, as every supported machine is
    hash = std::rotl(hash ^ Scrambled(block), 13) * 5 + 0xe6546b64u;
  }
  uint32_t tail = 0;
  for (size_t k = bytes.size(); k > i; --k) tail = tail << 8 | static_cast<unsigned char>(bytes[k - 1]);
  hash ^= Scrambled(tail);
  hash ^= static_cast<uint32_t>(bytes.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

float MatteId(std::string_view name) {
  const uint32_t hash = MurmurHash3(name);
  const uint32_t exponent = std::clamp(hash >> 23 & 255u, 1u, 254u);
  return std::bit_cast<float>((hash & 0x807fffffu) | exponent << 23);
}

MatteManifest MakeManifest(const std::vector<std::string>& names) {
  MatteManifest manifest;
  manifest.json = "{";
  std::set<std::string_view> seen;
  bool is_full = false;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) continue;
    if (is_full) continue;
    const std::string entry = fmt::format("{}{}:\"{:08x}\"", manifest.listed > 0 ? "," : "", Quoted(name),
                                          std::bit_cast<uint32_t>(MatteId(name)));
    is_full = manifest.json.size() + entry.size() >= kManifestBytesMax;
    if (is_full) continue;
    manifest.json += entry;
    ++manifest.listed;
  }
  manifest.json += "}";
  manifest.total = seen.size();
  return manifest;
}

void AddMatteAttributes(const std::string& layer, const MatteManifest& manifest,
                        std::map<std::string, std::string>& attributes) {
  const std::string key = "cryptomatte/" + fmt::format("{:08x}", MurmurHash3(layer)).substr(0, 7) + "/";
  attributes[key + "name"] = layer;
  attributes[key + "hash"] = "MurmurHash3_32";
  attributes[key + "conversion"] = "uint32_to_float32";
  attributes[key + "manifest"] = manifest.json;
}

}  // namespace tessera
