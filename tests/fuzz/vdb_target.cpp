#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "renderer/medium/nanovdb_file.h"
#include "renderer/medium/openvdb_file.h"
#include "renderer/util/check.h"
#include "tests/fuzz/targets.h"
#include "tests/renderer/medium/nanovdb_bytes.h"

namespace tessera {
namespace {

// What is read of a grid: its largest cubes of one value would take 1.5 GB, and a second each.
constexpr IndexBox kBox{{-100, -100, -100}, {155, 155, 155}};

// A valid grid with a few numbers overwritten: four bytes of place and eight of value each. No fuzzer makes
// such a grid by itself.
std::string PatchedGrid(std::string_view patches) {
  static const std::string grid =
      NanoVdbGridWriter("density", {-1, 0, 0}, {1, 1, 9}, [](VoxelIndex) { return 1.0f; }).bytes;
  std::string patched = grid;
  constexpr size_t kPlaceSize = 4, kPatchSize = kPlaceSize + 8;
  for (size_t at = 0; at + kPatchSize <= patches.size(); at += kPatchSize) {
    uint32_t place = 0;
    std::memcpy(&place, patches.data() + at, kPlaceSize);
    place = std::min(place, static_cast<uint32_t>(patched.size() - 8));
    patches.copy(patched.data() + place, 8, at + kPlaceSize);
  }
  return patched;
}

bool Try(const Result<std::shared_ptr<const VdbGrid>>& read) {
  if (!read) {
    TESSERA_CHECK(read.error().message.starts_with("a.vdb"));
    TESSERA_CHECK(read.error().message.find('\n') == std::string::npos);
    return false;
  }
  if (!*read) return false;
  const VoxelGrid<float>& voxels = (*read)->voxels;
  for (const float part : {0.0f, 0.3f, 1.0f}) {
    const auto at = [&](int i) { return part * static_cast<float>(voxels.size()[i] + 1); };
    const float value = voxels.Lookup({at(0), at(1), at(2)});
    TESSERA_CHECK(std::isfinite(value) && value >= 0);
  }
  return true;
}

}  // namespace

bool FuzzNanoVdb(std::string_view bytes) {
  const std::string patched = NanoVdbFileBytes({{"density", PatchedGrid(bytes)}}, false);
  Try(ReadNanoVdb(patched, "a.vdb", "density", kBox, false));
  return Try(ReadNanoVdb(bytes, "a.vdb", "density", kBox, false));
}

bool FuzzOpenVdb(std::string_view bytes) {
  return Try(ReadOpenVdb(bytes, "a.vdb", "density", kBox, false));
}

}  // namespace tessera
