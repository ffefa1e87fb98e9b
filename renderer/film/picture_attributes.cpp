#include "renderer/film/picture_attributes.h"

#include <ImfBoxAttribute.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfRationalAttribute.h>
#include <ImfStringAttribute.h>
#include <ImfTimeCodeAttribute.h>
#include <ImfVecAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

namespace tessera {
namespace {

// Attributes that describe the file itself: the writer sets them.
constexpr std::string_view kReservedAttributes[]{
    "channels",   "compression", "dataWindow",        "displayWindow",      "lineOrder", "name",
    "type",       "version",     "preview",           "screenWindowCenter", "view",      "screenWindowWidth",
    "chunkCount", "tiles",       "maxSamplesPerPixel"};

// Numbers with `separator` between them; nullopt if there is anything else.
template <typename T>
std::optional<std::vector<T>> ParseNumbers(std::string_view text, char separator, size_t count) {
  std::vector<T> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (numbers.size() < count) {
    T number{};
    const auto [rest, error] = std::from_chars(at, end, number);
    if (error != std::errc() || rest == at) return std::nullopt;
    numbers.push_back(number);
    at = rest;
    if (numbers.size() == count) break;
    if (at == end || *at != separator) return std::nullopt;
    ++at;
  }
  if (at != end) return std::nullopt;
  return numbers;
}

template <typename T>
std::string Joined(const T* numbers, size_t count) {
  std::string text;
  for (size_t i = 0; i < count; ++i) text += fmt::format("{}{}", i > 0 ? " " : "", numbers[i]);
  return text;
}

using Matrix = std::vector<float>;
std::optional<Matrix> ParseMatrix(std::string_view text) {
  auto matrix = ParseNumbers<float>(text, ' ', 16);
  if (!matrix || !std::ranges::all_of(*matrix, [](float x) { return std::isfinite(x); })) return std::nullopt;
  return matrix;
}

bool IsMatrix(const std::string& text) {
  return ParseMatrix(text).has_value();
}
void AddMatrix(const std::string& name, const std::string& text, Imf::Header& header) {
  const Matrix m = *ParseMatrix(text);
  const Imath::M44f matrix(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10], m[11], m[12],
                           m[13], m[14], m[15]);
  header.insert(name, Imf::M44fAttribute(matrix));
}

bool IsInt(const std::string& text) {
  return ParseNumbers<int>(text, ' ', 1).has_value();
}
void AddInt(const std::string& name, const std::string& text, Imf::Header& header) {
  header.insert(name, Imf::IntAttribute(ParseNumbers<int>(text, ' ', 1)->front()));
}

// Above zero.
bool IsFloat(const std::string& text) {
  const auto number = ParseNumbers<float>(text, ' ', 1);
  return number && std::isnormal(number->front()) && number->front() > 0;
}
void AddFloat(const std::string& name, const std::string& text, Imf::Header& header) {
  header.insert(name, Imf::FloatAttribute(ParseNumbers<float>(text, ' ', 1)->front()));
}

// "24000/1001"
bool IsRational(const std::string& text) {
  const auto parts = ParseNumbers<int>(text, '/', 2);
  return parts && (*parts)[0] >= 0 && (*parts)[1] > 0;
}
void AddRational(const std::string& name, const std::string& text, Imf::Header& header) {
  const auto parts = *ParseNumbers<int>(text, '/', 2);
  header.insert(name, Imf::RationalAttribute(Imf::Rational(parts[0], parts[1])));
}

// "01:00:59:23": hours, minutes, seconds and frames.
bool IsTimeCode(const std::string& text) {
  const auto parts = ParseNumbers<int>(text, ':', 4);
  constexpr int kEnds[] = {24, 60, 60, 60};
  for (size_t i = 0; parts && i < 4; ++i) {
    if ((*parts)[i] < 0 || (*parts)[i] >= kEnds[i]) return false;
  }
  return parts.has_value();
}
void AddTimeCode(const std::string& name, const std::string& text, Imf::Header& header) {
  const auto parts = *ParseNumbers<int>(text, ':', 4);
  header.insert(name, Imf::TimeCodeAttribute(Imf::TimeCode(parts[0], parts[1], parts[2], parts[3])));
}

struct TypedAttribute {
  std::string_view name;
  bool (*is_value)(const std::string& text);
  void (*add)(const std::string& name, const std::string& text, Imf::Header& header);
};
constexpr TypedAttribute kTypedAttributes[] = {
    {"worldToCamera", IsMatrix, AddMatrix},
    {"worldToNDC", IsMatrix, AddMatrix},
    {"frame", IsInt, AddInt},
    {"framesPerSecond", IsRational, AddRational},
    {"timeCode", IsTimeCode, AddTimeCode},
    {"pixelAspectRatio", IsFloat, AddFloat},
};

const TypedAttribute* FindTyped(const std::string& name) {
  const auto* const found = std::ranges::find(kTypedAttributes, name, &TypedAttribute::name);
  return found == std::end(kTypedAttributes) ? nullptr : found;
}

template <typename Attribute>
const Attribute* As(const Imf::Attribute& attribute) {
  return dynamic_cast<const Attribute*>(&attribute);
}

}  // namespace

bool IsReservedAttribute(const std::string& name) {
  return std::ranges::find(kReservedAttributes, name) != std::end(kReservedAttributes);
}

bool IsTypedAttribute(const std::string& name) {
  return FindTyped(name) != nullptr;
}

bool IsAttributeValue(const std::string& name, const std::string& text) {
  const TypedAttribute* const typed = FindTyped(name);
  return typed == nullptr || typed->is_value(text);
}

void AddAttribute(const std::string& name, const std::string& text, Imf::Header& header) {
  const TypedAttribute* const typed = FindTyped(name);
  if (typed != nullptr && typed->is_value(text)) {
    typed->add(name, text, header);
  } else {
    header.insert(name, Imf::StringAttribute(text));
  }
}

std::optional<std::string> AttributeText(const Imf::Attribute& attribute) {
  if (const auto* text = As<Imf::StringAttribute>(attribute)) return text->value();
  if (const auto* matrix = As<Imf::M44fAttribute>(attribute)) return Joined(matrix->value().getValue(), 16);
  if (const auto* matrix = As<Imf::M33fAttribute>(attribute)) return Joined(matrix->value().getValue(), 9);
  if (const auto* number = As<Imf::IntAttribute>(attribute)) return fmt::format("{}", number->value());
  if (const auto* number = As<Imf::FloatAttribute>(attribute)) return fmt::format("{}", number->value());
  if (const auto* number = As<Imf::DoubleAttribute>(attribute)) return fmt::format("{}", number->value());
  if (const auto* pair = As<Imf::V2fAttribute>(attribute)) return Joined(pair->value().getValue(), 2);
  if (const auto* pair = As<Imf::V2iAttribute>(attribute)) return Joined(pair->value().getValue(), 2);
  if (const auto* triple = As<Imf::V3fAttribute>(attribute)) return Joined(triple->value().getValue(), 3);
  if (const auto* number = As<Imf::RationalAttribute>(attribute))
    return fmt::format("{}/{}", number->value().n, number->value().d);
  if (const auto* code = As<Imf::TimeCodeAttribute>(attribute)) {
    const Imf::TimeCode& time = code->value();
    return fmt::format("{:02}:{:02}:{:02}:{:02}", time.hours(), time.minutes(), time.seconds(), time.frame());
  }
  if (const auto* colors = As<Imf::ChromaticitiesAttribute>(attribute)) {
    const Imf::Chromaticities& c = colors->value();
    const float numbers[] = {c.red.x,  c.red.y,  c.green.x, c.green.y,
                             c.blue.x, c.blue.y, c.white.x, c.white.y};
    return Joined(numbers, 8);
  }
  return std::nullopt;
}

}  // namespace tessera
