#include "renderer/shape/ply_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "renderer/shape/ply_header.h"
#include "renderer/shape/ply_values.h"

namespace tessera {
namespace {

// Where a vertex property goes: 0..2 position, 3..5 normal, 6 and 7 texture coordinates.
constexpr int kVertexFields = 8;
constexpr int kIgnored = -1;

struct VertexLayout {
  std::vector<int> fields;  // of each property of the element
  bool has_position = false, has_normals = false, has_uv = false;
};

int FindProperty(const PlyElement& element, std::string_view name) {
  for (size_t i = 0; i < element.properties.size(); ++i) {
    if (element.properties[i].name == name && !element.properties[i].is_list) return static_cast<int>(i);
  }
  return -1;
}

template <size_t kCount>
bool Assign(const PlyElement& element, const std::array<std::string_view, kCount>& names, int first_field,
            std::vector<int>* fields) {
  std::array<int, kCount> at;
  for (size_t i = 0; i < kCount; ++i) {
    at[i] = FindProperty(element, names[i]);
    if (at[i] < 0) return false;
  }
  for (size_t i = 0; i < kCount; ++i) (*fields)[at[i]] = first_field + static_cast<int>(i);
  return true;
}

VertexLayout LayoutOf(const PlyElement& element) {
  constexpr std::array<std::array<std::string_view, 2>, 4> kUvNames{
      {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}};
  VertexLayout layout;
  layout.fields.assign(element.properties.size(), kIgnored);
  layout.has_position = Assign<3>(element, {"x", "y", "z"}, 0, &layout.fields);
  layout.has_normals = Assign<3>(element, {"nx", "ny", "nz"}, 3, &layout.fields);
  for (const auto& names : kUvNames) {
    if (!layout.has_uv) layout.has_uv = Assign<2>(element, names, 6, &layout.fields);
  }
  return layout;
}

// Reads the elements of the body in the order of the header.
template <typename Values>
class BodyReader {
 public:
  BodyReader(const PlyHeader& header, Values values, const std::string& name)
      : header_(header), values_(values), name_(name) {}

  Result<PlyMesh> Read() {
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      const size_t size_min = element.SizeMin(header_.format);
      if (element.count > values_.Remaining() / size_min) {
        return BadInput(
            fmt::format("{}: truncated: the header announces {} elements \"{}\", of {} bytes or more "
                        "each, but only {} bytes are left",
                        name_, element.count, element.name, size_min, values_.Remaining()));
      }
      if (Result<void> done = ReadElement(element); !done) return done.error();
    }
    if (Result<void> done = CheckMesh(); !done) return done.error();
    if (Result<void> done = CheckPositions(); !done) return done.error();
    return std::move(mesh_);
  }

 private:
  Result<void> ReadElement(const PlyElement& element) {
    if (element.name == "vertex") return ReadVertices(element);
    if (element.name == "face") return ReadFaces(element);
    for (uint64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) {
        if (!SkipProperty(property)) return CutOff(element, i);
      }
    }
    return {};
  }

  Result<void> ReadVertices(const PlyElement& element) {
    const VertexLayout layout = LayoutOf(element);
    if (!layout.has_position) return Wrong("vertices have no properties x, y and z");
    if (!mesh_.P.empty()) return Wrong("more than one element \"vertex\"");
    if (element.count > std::numeric_limits<uint32_t>::max()) return Wrong("too many vertices");
    mesh_.P.reserve(element.count);
    if (layout.has_normals) mesh_.N.reserve(element.count);
    if (layout.has_uv) mesh_.uv.reserve(element.count);
    for (uint64_t i = 0; i < element.count; ++i) {
      float fields[kVertexFields] = {};
      for (size_t j = 0; j < element.properties.size(); ++j) {
        const PlyProperty& property = element.properties[j];
        const int field = layout.fields[j];
        const bool read =
            field == kIgnored ? SkipProperty(property) : values_.ReadFloat(property.type, &fields[field]);
        if (!read) return CutOff(element, i);
      }
      mesh_.P.push_back({fields[0], fields[1], fields[2]});
      all_finite_ &= IsFinite(mesh_.P.back());
      if (layout.has_normals) mesh_.N.push_back({fields[3], fields[4], fields[5]});
      if (layout.has_uv) mesh_.uv.push_back({fields[6], fields[7]});
    }
    return {};
  }

  Result<void> ReadFaces(const PlyElement& element) {
    const PlyProperty* corners = nullptr;
    for (const PlyProperty& p : element.properties) {
      if (p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index")) corners = &p;
    }
    if (!corners) return Wrong("faces have no list \"vertex_indices\"");
    if (!PlyIsInteger(corners->type)) return Wrong("vertex indices are not of an integer type");
    ReserveFaces(element, *corners);
    for (uint64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) {
        if (!(&property == corners ? ReadCorners(property) : SkipProperty(property)))
          return CutOff(element, i);
      }
    }
    return {};
  }

  // As many as the file can hold, were they all triangles.
  void ReserveFaces(const PlyElement& element, const PlyProperty& corners) {
    const bool is_ascii = header_.format == PlyFormat::kAscii;
    const size_t triangle_size = is_ascii ? 8 : PlySize(corners.count_type) + 3 * PlySize(corners.type);
    mesh_.triangles.reserve(3 * std::min<uint64_t>(element.count, values_.Remaining() / triangle_size));
  }

  bool ReadCorners(const PlyProperty& property) {
    int64_t count = 0;
    if (!values_.ReadInteger(property.count_type, &count) || count < 0) return false;
    if (count != 3 && count != 4) {
      ++mesh_.skipped_faces;
      return values_.Skip(property.type, static_cast<uint64_t>(count));
    }
    int64_t corner[4] = {};
    for (int64_t i = 0; i < count; ++i) {
      if (!values_.ReadInteger(property.type, &corner[i])) return false;
      index_min_ = std::min(index_min_, corner[i]);
      index_max_ = std::max(index_max_, corner[i]);
    }
    if (count == 3) {
      for (const int i : {0, 1, 2}) mesh_.triangles.push_back(static_cast<uint32_t>(corner[i]));
    } else {
      for (const int i : {0, 1, 3, 2}) mesh_.quads.push_back(static_cast<uint32_t>(corner[i]));
    }
    return true;
  }

  bool SkipProperty(const PlyProperty& property) {
    if (!property.is_list) return values_.Skip(property.type, 1);
    int64_t count = 0;
    if (!values_.ReadInteger(property.count_type, &count) || count < 0) return false;
    return values_.Skip(property.type, static_cast<uint64_t>(count));
  }

  Result<void> CheckMesh() const {
    if (mesh_.P.empty()) return Wrong("holds no vertices");
    if (mesh_.triangles.empty() && mesh_.quads.empty()) {
      return Wrong(mesh_.skipped_faces > 0 ? "holds no triangles or quads" : "holds no faces");
    }
    const int64_t vertices = static_cast<int64_t>(mesh_.P.size());
    if (index_min_ < 0 || index_max_ >= vertices) {
      return Wrong(fmt::format("a face refers to vertex {}, but there are {}",
                               index_min_ < 0 ? index_min_ : index_max_, vertices));
    }
    return {};
  }

  // A position that no face uses may hold anything; it becomes one that is used, so that all are finite.
  Result<void> CheckPositions() {
    if (all_finite_) return {};
    const uint32_t used = mesh_.triangles.empty() ? mesh_.quads[0] : mesh_.triangles[0];
    for (const std::vector<uint32_t>* faces : {&mesh_.triangles, &mesh_.quads}) {
      for (const uint32_t i : *faces) {
        if (!IsFinite(mesh_.P[i])) return Wrong(fmt::format("the position of vertex {} is not finite", i));
      }
    }
    for (Point3& p : mesh_.P) {
      if (!IsFinite(p)) p = mesh_.P[used];
    }
    return {};
  }

  Error Wrong(const std::string& what) const { return BadInput(name_ + ": " + what); }
  Error CutOff(const PlyElement& element, uint64_t index) {
    if (values_.AtEnd()) {
      return Wrong(fmt::format("truncated: {} {} of {} is cut off", element.name, index, element.count));
    }
    return Wrong(fmt::format("{} {} of {} is not written in numbers", element.name, index, element.count));
  }

  const PlyHeader& header_;
  Values values_;
  const std::string& name_;
  PlyMesh mesh_;
  int64_t index_min_ = 0, index_max_ = -1;
  bool all_finite_ = true;  // positions
};

}  // namespace

Result<PlyMesh> ReadPly(std::string_view bytes, const std::string& name) {
  const Result<PlyHeader> header = ReadPlyHeader(bytes, name);
  if (!header) return header.error();
  const std::string_view body = bytes.substr(header->data_offset);
  static_assert(std::endian::native == std::endian::little);
  switch (header->format) {
    case PlyFormat::kAscii: return BodyReader(*header, PlyAsciiValues(body), name).Read();
    case PlyFormat::kBinaryLittleEndian:
      return BodyReader(*header, PlyBinaryValues<false>(body), name).Read();
    case PlyFormat::kBinaryBigEndian: break;
  }
  return BodyReader(*header, PlyBinaryValues<true>(body), name).Read();
}

}  // namespace tessera
