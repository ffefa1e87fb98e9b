#include "coordinator/web/form.h"

#include <charconv>

namespace tessera {
namespace {

// The text up to `separator`, which is removed with it, or all of it.
std::string_view TakePart(std::string_view& text, char separator) {
  const size_t end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return part;
}

std::optional<std::string> Decode(std::string_view text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const std::string_view digits = text.substr(i + 1, 2);
    unsigned char byte = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
    if (digits.size() != 2 || error != std::errc() || end != digits.data() + 2) return std::nullopt;
    decoded += static_cast<char>(byte);
    i += 2;
  }
  return decoded;
}

}  // namespace

std::optional<std::map<std::string, std::string>> ParseForm(std::string_view body) {
  std::map<std::string, std::string> fields;
  while (!body.empty()) {
    std::string_view value = TakePart(body, '&');
    const auto name = Decode(TakePart(value, '='));
    auto decoded = Decode(value);
    if (!name || !decoded || fields.size() == kFormFieldsMax) return std::nullopt;
    if (!fields.emplace(*name, std::move(*decoded)).second) return std::nullopt;
  }
  return fields;
}

std::string CookieValue(std::string_view cookies, std::string_view name) {
  std::string found;
  while (!cookies.empty()) {
    std::string_view value = TakePart(cookies, ';');
    while (value.starts_with(' ')) value.remove_prefix(1);
    if (TakePart(value, '=') != name) continue;
    if (!found.empty()) return {};
    found = value;
  }
  return found;
}

}  // namespace tessera
