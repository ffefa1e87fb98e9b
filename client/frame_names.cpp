#include "client/frame_names.h"

#include <fmt/format.h>

#include <filesystem>

namespace tessera {
namespace {

constexpr size_t kDigitsMax = 16;  // of a printf-like place: more is no frame number

// A place for a number at the front of `text`: how long it is, and how many digits it wants. Length 0: none.
struct Place {
  size_t length = 0;
  size_t digits = 1;
};

Place PlaceAtFront(std::string_view text) {
  if (text.starts_with('#')) {
    const size_t length = std::min(text.find_first_not_of('#'), text.size());
    return {length, length};
  }
  if (!text.starts_with('%')) return {};
  size_t i = 1, digits = 0;
  if (i < text.size() && text[i] == '0') {
    for (++i; i < text.size() && text[i] >= '0' && text[i] <= '9' && digits <= kDigitsMax; ++i) {
      digits = digits * 10 + static_cast<size_t>(text[i] - '0');
    }
    if (digits < 1 || digits > kDigitsMax) return {};
  }
  if (i >= text.size() || text[i] != 'd') return {};
  return {i + 1, std::max<size_t>(digits, 1)};
}

}  // namespace

bool IsFramePattern(std::string_view name) {
  for (; !name.empty(); name.remove_prefix(1)) {
    if (PlaceAtFront(name).length > 0) return true;
  }
  return false;
}

std::string NameOfFrame(std::string_view pattern, int number) {
  std::string name;
  while (!pattern.empty()) {
    const Place place = PlaceAtFront(pattern);
    if (place.length > 0) {
      name += fmt::format("{:0{}}", number, place.digits);
      pattern.remove_prefix(place.length);
    } else {
      name += pattern.front();
      pattern.remove_prefix(1);
    }
  }
  return name;
}

std::string AsFramePattern(const std::string& name) {
  if (IsFramePattern(name)) return name;
  std::filesystem::path path(name);
  const std::string ending = path.extension().string();
  return path.replace_extension().string() + ".####" + ending;
}

}  // namespace tessera
