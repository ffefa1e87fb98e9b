#include "renderer/description/number_list.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/description/number.h"

namespace tessera {
namespace {

bool IsSpace(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

}  // namespace

Result<std::vector<float>> ParseNumberList(const std::string& text) {
  std::vector<float> numbers;
  int line = 1;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at < end) {
    if (IsSpace(*at)) {
      line += *at++ == '\n';
    } else if (*at == '#') {
      at = std::find(at, end, '\n');
    } else {
      float number = 0;
      const auto [rest, problem] = ReadNumber(at, end, number);
      if (problem != std::errc() || (rest < end && !IsSpace(*rest) && *rest != '#')) {
        return BadInput(fmt::format("line {} has a word that is not a number", line));
      }
      numbers.push_back(number);
      at = rest;
    }
  }
  return numbers;
}

}  // namespace tessera
