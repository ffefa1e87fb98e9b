#include "renderer/shape/ply_header.h"

#include <fmt/format.h>

#include <array>
#include <optional>

#include "renderer/description/number.h"

namespace tessera {
namespace {

// Limits on what is only ever a few lines: files that exceed them are not meshes.
constexpr size_t kHeaderSizeMax = size_t{1} << 20;  // bytes
constexpr size_t kElementsMax = 64;
constexpr size_t kPropertiesMax = 256;  // of one element

std::vector<std::string_view> Words(std::string_view line) {
  constexpr std::string_view kSpace = " \t\r";
  std::vector<std::string_view> words;
  for (size_t at = line.find_first_not_of(kSpace); at != line.npos; at = line.find_first_not_of(kSpace, at)) {
    const size_t end = std::min(line.find_first_of(kSpace, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

std::optional<PlyType> TypeNamed(std::string_view word) {
  struct Name {
    std::string_view word;
    PlyType type;
  };
  static constexpr std::array<Name, 16> kNames{{{"char", PlyType::kInt8},
                                                {"int8", PlyType::kInt8},
                                                {"uchar", PlyType::kUint8},
                                                {"uint8", PlyType::kUint8},
                                                {"short", PlyType::kInt16},
                                                {"int16", PlyType::kInt16},
                                                {"ushort", PlyType::kUint16},
                                                {"uint16", PlyType::kUint16},
                                                {"int", PlyType::kInt32},
                                                {"int32", PlyType::kInt32},
                                                {"uint", PlyType::kUint32},
                                                {"uint32", PlyType::kUint32},
                                                {"float", PlyType::kFloat32},
                                                {"float32", PlyType::kFloat32},
                                                {"double", PlyType::kFloat64},
                                                {"float64", PlyType::kFloat64}}};
  for (const Name& name : kNames) {
    if (name.word == word) return name.type;
  }
  return std::nullopt;
}

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Result<PlyHeader> Parse() {
    FindLineEnd();
    if (NextLine() != "ply") return BadInput(name_ + ": not a PLY file: it does not start with \"ply\"");
    for (;;) {
      if (at_ >= bytes_.size() || at_ > kHeaderSizeMax)
        return Wrong("truncated: the header has no \"end_header\"");
      const std::vector<std::string_view> words = Words(NextLine());
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (Result<void> done = Line(words); !done) return done.error();
    }
    if (!has_format_) return Wrong("the header names no format");
    header_.data_offset = at_;
    return header_;
  }

 private:
  // Files from old Macintosh programs end their lines by "\r" alone: the first line tells.
  void FindLineEnd() {
    const size_t first = bytes_.substr(0, kHeaderSizeMax).find_first_of("\r\n");
    if (first == bytes_.npos || bytes_[first] == '\n') return;
    if (bytes_.substr(first + 1, 1) != "\n") line_end_ = '\r';
  }

  // Without its end, be that "\n", "\r\n" or "\r".
  std::string_view NextLine() {
    const size_t end = bytes_.find(line_end_, at_);
    std::string_view line = bytes_.substr(at_, end == bytes_.npos ? bytes_.npos : end - at_);
    at_ = end == bytes_.npos ? bytes_.size() : end + 1;
    ++line_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  Error Wrong(const std::string& what) const {
    return BadInput(fmt::format("{}:{}: {}", name_, line_, what));
  }

  Result<void> Line(const std::vector<std::string_view>& words) {
    if (words[0] == "format") return Format(words);
    if (words[0] == "element") return Element(words);
    if (words[0] == "property") return Property(words);
    return Wrong(fmt::format("unknown header line \"{}\"", words[0].substr(0, 40)));
  }

  Result<void> Format(const std::vector<std::string_view>& words) {
    if (words.size() < 2) return Wrong("expected the name of a format");
    if (words[1] == "ascii") {
      header_.format = PlyFormat::kAscii;
    } else if (words[1] == "binary_little_endian") {
      header_.format = PlyFormat::kBinaryLittleEndian;
    } else if (words[1] == "binary_big_endian") {
      header_.format = PlyFormat::kBinaryBigEndian;
    } else {
      return Wrong(fmt::format("unknown format \"{}\"", words[1].substr(0, 40)));
    }
    has_format_ = true;
    return {};
  }

  Result<void> Element(const std::vector<std::string_view>& words) {
    if (words.size() != 3) return Wrong("expected \"element NAME COUNT\"");
    PlyElement element;
    element.name = words[1];
    const std::optional<uint64_t> count = ParseNumber<uint64_t>(words[2]);
    if (!count) {
      return Wrong(fmt::format("\"{}\" is not a number of elements", words[2].substr(0, 40)));
    }
    element.count = *count;
    if (header_.elements.size() == kElementsMax) return Wrong("too many kinds of elements");
    header_.elements.push_back(std::move(element));
    return {};
  }

  Result<void> Property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) return Wrong("a property before the first element");
    std::vector<PlyProperty>& properties = header_.elements.back().properties;
    if (properties.size() == kPropertiesMax) return Wrong("too many properties");
    const bool is_list = words.size() > 1 && words[1] == "list";
    if (words.size() != (is_list ? 5u : 3u)) {
      return Wrong("expected \"property TYPE NAME\" or \"property list COUNT-TYPE TYPE NAME\"");
    }
    const std::optional<PlyType> type = TypeNamed(words[is_list ? 3 : 1]);
    const std::optional<PlyType> count_type = is_list ? TypeNamed(words[2]) : PlyType::kUint8;
    if (!type || !count_type) return Wrong("unknown property type");
    if (!PlyIsInteger(*count_type)) return Wrong("the length of a list must be of an integer type");
    properties.push_back({std::string(words.back()), *type, is_list, *count_type});
    return {};
  }

  std::string_view bytes_;
  const std::string& name_;
  size_t at_ = 0;
  int line_ = 0;
  char line_end_ = '\n';
  bool has_format_ = false;
  PlyHeader header_;
};

}  // namespace

size_t PlySize(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8: return 1;
    case PlyType::kInt16:
    case PlyType::kUint16: return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32: return 4;
    case PlyType::kFloat64: break;
  }
  return 8;
}

size_t PlyElement::SizeMin(PlyFormat format) const {
  size_t size = 0;
  for (const PlyProperty& p : properties) {
    size += format == PlyFormat::kAscii ? 1 : PlySize(p.is_list ? p.count_type : p.type);
  }
  return size;
}

Result<PlyHeader> ReadPlyHeader(std::string_view bytes, const std::string& name) {
  return HeaderParser(bytes, name).Parse();
}

}  // namespace tessera
