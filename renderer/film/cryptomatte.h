// Names of mattes as Cryptomatte files hold them (Friedman and Jones 2015, specification 1.2): a name is
// hashed to an id that is a float, and the header of the file says which names have which ids. Names that
// hash to the same id share a matte, which the format cannot avoid: among 10,000 names that happens once in
// 50 pictures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// MurmurHash3_x86_32 with seed 0 (Appleby 2011).
uint32_t MurmurHash3(std::string_view bytes);

// The id of a name: the bits of its hash, with an exponent between 1 and 254, so that it is never zero, a
// denormal, infinite or NaN. The bytes of the name count.
float MatteId(std::string_view name);

// Of the names of one layer in the header of a file: what an attribute may hold, with some room.
constexpr size_t kManifestBytesMax = 60'000;

// A list of names and their ids as JSON text of at most kManifestBytesMax bytes. `names` are UTF-8 without
// control characters; one that appears twice is listed once. What has no room is left out, the first names
// come first.
struct MatteManifest {
  std::string json;
  size_t listed = 0;  // names in it
  size_t total = 0;   // different names
};
MatteManifest MakeManifest(const std::vector<std::string>& names);

// Adds what the header of a file says of the layer: name, hash, conversion and manifest.
void AddMatteAttributes(const std::string& layer, const MatteManifest& manifest,
                        std::map<std::string, std::string>& attributes);

}  // namespace tessera
