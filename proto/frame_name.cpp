#include "proto/frame_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace tessera {
namespace {

constexpr size_t kDigitsMax = 16;  // of a printf-like place: more is no frame number

// The length of the place at the start of `text` and its number of digits. Length 0: there is none.
struct PlaceAtStart {
  size_t length = 0;
  size_t digits = 1;
};

PlaceAtStart FindPlace(std::string_view text) {
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

FrameName::FrameName(std::string name) : text_(std::move(name)) {
  for (size_t i = text_.rfind('/') + 1; i < text_.size();) {  // npos + 1 is 0
    const PlaceAtStart place = FindPlace(std::string_view(text_).substr(i));
    if (place.length > 0) places_.push_back({i, place.length, place.digits});
    i += std::max<size_t>(place.length, 1);
  }
}

std::string FrameName::Of(int number) const {
  std::string name;
  size_t copied = 0;
  for (const Place& place : places_) {
    name += text_.substr(copied, place.begin - copied) + fmt::format("{:0{}}", number, place.digits);
    copied = place.begin + place.length;
  }
  return name + text_.substr(copied);
}

FrameName FrameName::WithPlace() const {
  if (HasPlace()) return *this;
  std::filesystem::path path(text_);
  const std::string extension = path.extension().string();
  return FrameName(path.replace_extension().string() + ".####" + extension);
}

}  // namespace tessera
