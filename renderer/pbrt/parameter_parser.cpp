// Parameter lists: "type name" value or "type name" [ values ].
#include <fmt/format.h>

#include <algorithm>

#include "renderer/description/number.h"
#include "renderer/pbrt/scene_parser.h"
#include "renderer/text/unicode.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 13> kTypeWords{"bool",   "float",     "integer", "point2", "vector2",
                                                      "point3", "vector3",   "normal",  "string", "texture",
                                                      "rgb",    "blackbody", "spectrum"};

bool IsType(std::string_view type) {
  return std::find(kTypeWords.begin(), kTypeWords.end(), type) != kTypeWords.end();
}

std::string UnknownType(std::string_view type) {
  return fmt::format("unknown parameter type {}{}, expected one of {}", Quoted(type),
                     DidYouMean(type, kTypeWords), fmt::join(kTypeWords, " "));
}

std::string_view TakeWord(std::string_view* text) {
  constexpr std::string_view kBlanks = " \t";
  text->remove_prefix(std::min(text->find_first_not_of(kBlanks), text->size()));
  const std::string_view word = text->substr(0, text->find_first_of(kBlanks));
  text->remove_prefix(word.size());
  return word;
}

// What the values of a parameter should be, for messages.
std::string Expected(ValueKind kind, const Parameter& p) {
  const char* what = kind == ValueKind::kInteger    ? "a 32-bit integer"
                     : kind == ValueKind::kString   ? "a string"
                     : kind == ValueKind::kBool     ? "true or false without quotes"
                     : kind == ValueKind::kSpectrum ? "all numbers or one name"
                                                    : "a number";
  return fmt::format("{} for \"{} {}\"", what, p.type, p.name);
}

std::optional<float> NumberOf(const Token& token) {
  return token.kind == Token::Kind::kWord ? ParseFloat(token.text) : std::nullopt;
}

size_t ValueCount(const Parameter& p) {
  return p.floats.size() + p.integers.size() + p.strings.size() + p.bools.size();
}

}  // namespace

ValueKind ValueKindOf(std::string_view type) {
  if (type == "integer") return ValueKind::kInteger;
  if (type == "string" || type == "texture") return ValueKind::kString;
  if (type == "bool") return ValueKind::kBool;
  if (type == "spectrum") return ValueKind::kSpectrum;
  return ValueKind::kNumber;
}

std::optional<std::vector<Parameter>> SceneParser::ReadParameters() {
  std::vector<Parameter> parameters;
  while (tokens_.Peek().kind == Token::Kind::kString) {
    std::optional<Parameter> parameter = ReadParameter();
    if (!parameter) return std::nullopt;
    parameters.push_back(*std::move(parameter));
  }
  if (tokens_.Peek().kind == Token::Kind::kBad) {
    Unexpected(tokens_.Peek(), "");
    return std::nullopt;
  }
  return parameters;
}

std::optional<Parameter> SceneParser::ReadDeclaration(const Token& token) {
  std::string_view declaration = token.text;
  const std::string_view type = TakeWord(&declaration);
  const std::string_view name = TakeWord(&declaration);
  const SourceLocation location = token.Location();
  if (name.empty()) {
    Fail(location, fmt::format("{} is not a parameter, expected \"type name\"", Quoted(token.text)));
    return std::nullopt;
  }
  if (!IsType(type)) {
    Fail(location, UnknownType(type));
    return std::nullopt;
  }
  if (name.size() > kNameLengthMax) {
    Fail(location, fmt::format("parameter name longer than {} bytes", kNameLengthMax));
    return std::nullopt;
  }
  Parameter parameter;
  parameter.type = type;
  parameter.name = name;
  parameter.location = location;
  parameter.color_space = state_.color_space;
  return parameter;
}

std::optional<Parameter> SceneParser::ReadParameter() {
  std::optional<Parameter> parameter = ReadDeclaration(tokens_.Next());
  if (!parameter) return std::nullopt;
  Parameter& p = *parameter;
  const ValueKind kind = ValueKindOf(p.type);
  const Token first = tokens_.Next();
  if (first.kind != Token::Kind::kOpen) {
    if (!ReadValue(first, kind, p)) return std::nullopt;
    return parameter;
  }
  while (true) {
    const Token token = tokens_.Next();
    if (token.kind == Token::Kind::kClose) break;
    if (token.kind == Token::Kind::kEnd) {
      Unexpected(token, fmt::format("\"]\" after the values of \"{} {}\"", p.type, p.name));
      return std::nullopt;
    }
    if (!ReadValue(token, kind, p)) return std::nullopt;
  }
  if (ValueCount(p) == 0) {
    Fail(p.location, fmt::format("\"{} {}\" has no values, expected at least one", p.type, p.name));
    return std::nullopt;
  }
  p.floats.shrink_to_fit();
  p.integers.shrink_to_fit();
  return parameter;
}

bool SceneParser::ReadValue(const Token& token, ValueKind kind, Parameter& p) {
  const bool is_string = token.kind == Token::Kind::kString;
  const bool is_word = token.kind == Token::Kind::kWord;
  if (kind == ValueKind::kNumber || (kind == ValueKind::kSpectrum && !is_string && p.strings.empty())) {
    if (const std::optional<float> value = NumberOf(token)) {
      p.floats.push_back(*value);
      return true;
    }
  } else if (kind == ValueKind::kInteger) {
    if (const std::optional<int> value = is_word ? ParseInteger(token.text) : std::nullopt) {
      p.integers.push_back(*value);
      return true;
    }
  } else if (kind == ValueKind::kBool) {
    if (is_word && (token.text == "true" || token.text == "false")) {
      p.bools.push_back(token.text == "true");
      return true;
    }
  } else if (is_string && p.floats.empty()) {
    p.strings.push_back(p.type == "texture" ? Normalize(token.text) : std::string(token.text));
    return true;
  }
  return Unexpected(token, Expected(kind, p));
}

}  // namespace tessera
