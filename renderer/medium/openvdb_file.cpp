#include "renderer/medium/openvdb_file.h"

#include <fmt/format.h>

#include "renderer/medium/openvdb_tree.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::string_view kVdbMagic{" BDV\0\0\0\0", 8};
constexpr uint32_t kVersionMin = 222, kVersionMax = 224;  // since 2013; later ones do not exist
constexpr uint64_t kUuidSize = 36;
constexpr char kNameSeparator = '\x1e';  // before a number that tells grids of one name apart
constexpr std::string_view kFloatTree = "Tree_float_5_4_3", kHalfTree = "Tree_float_5_4_3_HalfFloat";

// Skips named values, of which the text of `wanted` is returned.
std::string_view ReadMetadata(VdbCursor& in, std::string_view wanted) {
  std::string_view found;
  const uint32_t count = in.Unsigned32();
  for (uint32_t i = 0; i < count && !in.failed(); ++i) {
    const std::string_view name = in.Text();
    in.Text();  // the type
    const std::string_view value = in.Text();
    if (name == wanted) found = value;
  }
  return found;
}

// The matrix of the map from voxel indices to space. Returns an error text, or an empty one.
std::string ReadMap(VdbCursor& in, Matrix4& matrix) {
  const std::string_view type = in.Text();
  matrix = {};
  const auto read_three = [&in] {
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = static_cast<float>(in.Double());
    return v;
  };
  const auto scale = [&matrix](Vec3 v) {
    for (int i = 0; i < 3; ++i) matrix.m[i][i] = v[i];
  };
  const auto translate = [&matrix](Vec3 v) {
    for (int i = 0; i < 3; ++i) matrix.m[i][3] = v[i];
  };
  constexpr uint64_t kDerivedSize = 4 * 24;  // the size of a voxel, and inverses
  if (type == "ScaleMap" || type == "UniformScaleMap") {
    scale(read_three());
    in.Take(kDerivedSize);
  } else if (type == "ScaleTranslateMap" || type == "UniformScaleTranslateMap") {
    translate(read_three());
    scale(read_three());
    in.Take(kDerivedSize);
  } else if (type == "TranslationMap") {
    translate(read_three());
  } else if (type == "AffineMap" || type == "UnitaryMap") {
    // Of row vectors.
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) matrix.m[row][column] = static_cast<float>(in.Double());
    }
  } else {
    return fmt::format("its map \"{}\" is not supported", OneLine(type));
  }
  return "";
}

struct FoundGrid {
  uint64_t at = 0;
  std::string_view tree;
};

// The grid of this name. Returns a grid at 0 if there is none. `in` is behind the header.
FoundGrid FindGrid(VdbCursor& in, std::string_view name) {
  FoundGrid found;
  const uint32_t grids = in.Unsigned32();
  uint64_t previous_end = 0;
  for (uint32_t i = 0; i < grids && !in.failed(); ++i) {
    const std::string_view unique_name = in.Text(), tree = in.Text();
    in.Text();  // the grid whose tree it shares
    const uint64_t at = in.Integer(8);
    in.Integer(8);  // where its values start
    const uint64_t end = in.Integer(8);
    if (found.at == 0 && unique_name.substr(0, unique_name.find(kNameSeparator)) == name) found = {at, tree};
    // The next description follows the grid.
    if (in.failed() || end <= previous_end || !in.MoveTo(end)) break;
    previous_end = end;
  }
  return found;
}

class OpenVdbFile {
 public:
  OpenVdbFile(std::string_view bytes, const std::string& file, const std::string& name)
      : in_(bytes), file_(file), name_(name) {}

  Result<std::shared_ptr<const VdbGrid>> Read(const std::optional<IndexBox>& box, bool may_be_negative) {
    if (const std::string problem = ReadHeader(); !problem.empty())
      return BadInput(fmt::format("{}: {}", file_, problem));
    const FoundGrid found = FindGrid(in_, name_);
    if (in_.failed()) return BadInput(file_ + ": damaged OpenVDB file: unexpected end of file");
    if (found.at == 0) return std::shared_ptr<const VdbGrid>();
    if (found.tree != kFloatTree && found.tree != kHalfTree)
      return Fail(fmt::format("is a {}, only {} is read", OneLine(found.tree), kFloatTree));
    if (!in_.MoveTo(found.at)) return Fail("lies beyond the end of the file");
    const VdbStorage storage{in_.Unsigned32(), found.tree == kHalfTree};
    if (ReadMetadata(in_, "class") == "level set") return Fail("is not a fog volume");
    Matrix4 matrix;
    if (const std::string problem = ReadMap(in_, matrix); !problem.empty())
      return Fail("cannot be read: " + problem);
    const std::optional<Transform> map = Transform::FromMatrix(matrix);
    if (!map) return Fail("has a map to space without an inverse");
    OpenVdbTree tree(in_, storage);
    if (const std::string problem = tree.ReadTopology(); !problem.empty())
      return Fail("cannot be read: " + problem);
    const IndexBox used = box.value_or(tree.active_box());
    if (const std::string problem = BoxProblem(used); !problem.empty()) return Fail(problem);
    auto grid = std::make_shared<VdbGrid>(VdbGrid{VoxelGrid<float>(used.Size()), used, *map});
    if (const std::string problem = tree.ReadVoxels(may_be_negative, grid.get()); !problem.empty())
      return Fail("cannot be read: " + problem);
    return std::shared_ptr<const VdbGrid>(std::move(grid));
  }

 private:
  std::string ReadHeader() {
    in_.Take(kVdbMagic.size());
    const uint32_t version = in_.Unsigned32();
    in_.Integer(8);  // the version of the library
    const bool has_places = in_.Integer(1) != 0;
    in_.Take(kUuidSize);
    ReadMetadata(in_, "");
    if (in_.failed()) return "damaged OpenVDB file: unexpected end of file";
    if (version < kVersionMin || version > kVersionMax) {
      return fmt::format("OpenVDB files of version {} are not supported, only versions {} to {}", version,
                         kVersionMin, kVersionMax);
    }
    return has_places ? "" : "OpenVDB files without the places of their grids are not supported";
  }
  Error Fail(const std::string& why) const {
    return BadInput(fmt::format("{}: grid \"{}\" {}", file_, OneLine(name_), why));
  }

  VdbCursor in_;
  const std::string& file_;
  const std::string& name_;
};

}  // namespace

bool IsOpenVdb(std::string_view bytes) {
  return bytes.starts_with(kVdbMagic);
}

Result<std::shared_ptr<const VdbGrid>> ReadOpenVdb(std::string_view bytes, const std::string& file,
                                                   const std::string& name,
                                                   const std::optional<IndexBox>& box, bool may_be_negative) {
  return OpenVdbFile(bytes, file, name).Read(box, may_be_negative);
}

}  // namespace tessera
