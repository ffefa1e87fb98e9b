#include "renderer/image/orientation.h"

#include <cstring>
#include <utility>

namespace tessera {
namespace {

// The four words of the line that follows the empty line at the end of the header.
std::optional<std::array<std::string_view, 4>> ResolutionWords(std::string_view bytes) {
  const size_t end_of_header = bytes.find("\n\n");
  if (end_of_header == std::string_view::npos) return std::nullopt;
  std::string_view line = bytes.substr(end_of_header + 2);
  line = line.substr(0, line.find('\n'));
  std::array<std::string_view, 4> words;
  for (std::string_view& word : words) {
    line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
    word = line.substr(0, line.find(' '));
    line.remove_prefix(word.size());
  }
  return words;
}

bool IsAxis(std::string_view word, char name) {
  return word.size() == 2 && (word[0] == '+' || word[0] == '-') && word[1] == name;
}

}  // namespace

std::optional<Orientation> OrientationOfTag(int value) {
  switch (value) {
    case 1: return Orientation{};
    case 2: return Orientation{false, true, false};
    case 3: return Orientation{false, true, true};
    case 4: return Orientation{false, false, true};
    case 5: return Orientation{true, false, false};
    case 6: return Orientation{true, true, false};
    case 7: return Orientation{true, true, true};
    case 8: return Orientation{true, false, true};
    default: return std::nullopt;
  }
}

std::optional<Orientation> OrientationOfRadiance(std::string_view bytes) {
  const auto words = ResolutionWords(bytes);
  if (!words) return std::nullopt;
  const bool is_transposed = IsAxis((*words)[0], 'X');
  const std::string_view x = (*words)[is_transposed ? 0 : 2], y = (*words)[is_transposed ? 2 : 0];
  if (!IsAxis(x, 'X') || !IsAxis(y, 'Y')) return std::nullopt;
  return Orientation{is_transposed, x[0] == '-', y[0] == '+'};
}

void MakeUpright(Image& image, Orientation orientation) {
  if (orientation == Orientation{}) return;
  const auto width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  const size_t pixel_size = image.bytes.size() / (width * height);
  const size_t new_width = orientation.is_transposed ? height : width;
  const size_t new_height = orientation.is_transposed ? width : height;
  std::vector<uint8_t> upright(image.bytes.size());
  for (size_t y = 0; y < new_height; ++y) {
    for (size_t x = 0; x < new_width; ++x) {
      size_t from_x = orientation.flips_x ? new_width - 1 - x : x;
      size_t from_y = orientation.flips_y ? new_height - 1 - y : y;
      if (orientation.is_transposed) std::swap(from_x, from_y);
      std::memcpy(&upright[(y * new_width + x) * pixel_size],
                  &image.bytes[(from_y * width + from_x) * pixel_size], pixel_size);
    }
  }
  image.bytes = std::move(upright);
  image.width = static_cast<int>(new_width);
  image.height = static_cast<int>(new_height);
}

}  // namespace tessera
