#include "renderer/medium/nanovdb_file.h"

#include <zlib.h>

#include <fmt/format.h>

#include "renderer/medium/nanovdb_tree.h"
#include "renderer/util/header_reader.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::string_view kFileMagic = "NanoVDB0";
constexpr uint32_t kMajorVersion = 32;
constexpr int kMajorVersionBits = 21;  // the version is shifted by this many
constexpr uint32_t kCodecNone = 0, kCodecZip = 1;
// Sizes and places of what precedes the grids (IO.h of NanoVDB 32).
constexpr uint64_t kMetaSize = 176, kMetaNameSizeAt = 136;

// A grid as the file announces it.
struct Announced {
  uint64_t unpacked_size = 0, packed_size = 0;
  std::string_view name;
};

std::optional<uint64_t> Little64(HeaderReader& in) {
  const auto low = in.Little32(), high = low ? in.Little32() : std::nullopt;
  return high ? std::optional(uint64_t{*high} << 32 | *low) : std::nullopt;
}

std::optional<Announced> ReadAnnounced(HeaderReader& in) {
  Announced grid;
  const std::optional<std::string_view> meta = in.Take(kMetaSize);
  if (!meta) return std::nullopt;
  HeaderReader sizes(*meta);
  grid.unpacked_size = *Little64(sizes);
  grid.packed_size = *Little64(sizes);
  HeaderReader name(meta->substr(kMetaNameSizeAt));
  const std::optional<std::string_view> text = in.Take(*name.Little32());
  if (!text) return std::nullopt;
  grid.name = text->substr(0, text->find('\0'));
  return grid;
}

class NanoVdbFile {
 public:
  NanoVdbFile(std::string_view bytes, const std::string& file) : in_(bytes), file_(file) {}

  // The unpacked bytes of the grid; nullopt if there is none of this name.
  Result<std::optional<std::string>> Find(const std::string& name) {
    while (!in_.Rest().empty()) {
      if (in_.Take(kFileMagic.size()) != kFileMagic) return Damaged("it is not a NanoVDB file");
      const auto version = in_.Little32();
      const auto grids = version ? in_.Little(2) : std::nullopt, codec = grids ? in_.Little(2) : std::nullopt;
      if (!codec) return Damaged("unexpected end of file");
      if (*version >> kMajorVersionBits != kMajorVersion) {
        return BadInput(fmt::format("{}: NanoVDB files of version {} are not supported, only version {}",
                                    file_, *version >> kMajorVersionBits, kMajorVersion));
      }
      std::vector<Announced> announced;
      for (uint32_t i = 0; i < *grids; ++i) {
        const std::optional<Announced> grid = ReadAnnounced(in_);
        if (!grid) return Damaged("unexpected end of file");
        announced.push_back(*grid);
      }
      for (const Announced& grid : announced) {
        const std::optional<std::string_view> packed = in_.Take(grid.packed_size);
        if (!packed) return Damaged("unexpected end of file");
        if (grid.name == name) return Unpack(*packed, grid.unpacked_size, *codec);
      }
    }
    return std::optional<std::string>();
  }

  Error Damaged(const std::string& why) const {
    return BadInput(fmt::format("{}: damaged NanoVDB file: {}", file_, OneLine(why)));
  }

 private:
  Result<std::optional<std::string>> Unpack(std::string_view packed, uint64_t size, uint32_t codec) const {
    if (codec == kCodecNone) {
      if (size != packed.size()) return Damaged("a grid has another size than announced");
      return std::optional(std::string(packed));
    }
    if (codec != kCodecZip) {
      return BadInput(
          fmt::format("{}: its compression is not supported, only ZIP or none (nanovdb_convert -z)", file_));
    }
    HeaderReader in(packed);
    const std::optional<uint64_t> deflated_size = Little64(in);
    if (deflated_size != in.Rest().size()) return Damaged("a grid has another size than announced");
    if (size > kVdbBytesMax || size / kVdbExpansionMax > packed.size())
      return Damaged(fmt::format("{} bytes cannot hold a grid of {} bytes", packed.size(), size));
    std::string unpacked(size, '\0');
    uLongf length = size;
    const int status = uncompress(reinterpret_cast<Bytef*>(unpacked.data()), &length,
                                  reinterpret_cast<const Bytef*>(in.Rest().data()), in.Rest().size());
    if (status != Z_OK || length != size) return Damaged("a grid cannot be unpacked");
    return std::optional(std::move(unpacked));
  }

  HeaderReader in_;
  const std::string& file_;
};

}  // namespace

Result<std::shared_ptr<const VdbGrid>> ReadNanoVdb(std::string_view bytes, const std::string& file,
                                                   const std::string& name,
                                                   const std::optional<IndexBox>& box, bool may_be_negative) {
  NanoVdbFile nanovdb(bytes, file);
  const Result<std::optional<std::string>> unpacked = nanovdb.Find(name);
  if (!unpacked) return unpacked.error();
  if (!*unpacked) return std::shared_ptr<const VdbGrid>();
  const auto fail = [&](const std::string& why) {
    return BadInput(fmt::format("{}: grid \"{}\" {}", file, OneLine(name), why));
  };
  NanoVdbTree tree(**unpacked);
  if (const std::string problem = tree.ReadHeader(); !problem.empty())
    return fail("cannot be read: " + problem);
  const std::optional<Transform> map = Transform::FromMatrix(tree.world_from_index());
  if (!map) return fail("has a map to space without an inverse");
  const IndexBox used = box.value_or(tree.active_box());
  if (const std::string problem = BoxProblem(used); !problem.empty()) return fail(problem);
  auto grid = std::make_shared<VdbGrid>(VdbGrid{VoxelGrid<float>(used.Size()), used, *map});
  if (const std::string problem = tree.ReadVoxels(may_be_negative, grid.get()); !problem.empty())
    return fail("cannot be read: " + problem);
  return std::shared_ptr<const VdbGrid>(std::move(grid));
}

}  // namespace tessera
