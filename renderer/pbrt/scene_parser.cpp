#include "renderer/pbrt/scene_parser.h"

#include <fmt/format.h>

#include "renderer/description/number.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

std::string Describe(const Token& token) {
  switch (token.kind) {
    case Token::Kind::kEnd: return "end of the file";
    case Token::Kind::kString: return "string " + Quoted(token.text);
    default: return Quoted(token.text);
  }
}

// Words of which people may think that they are directives.
std::string UnknownDirective(std::string_view word) {
  if (word == "WorldEnd")
    return "unknown directive \"WorldEnd\": pbrt-v4 has none, the world ends with the file";
  std::vector<std::string_view> names;
  for (const Directive& directive : Directives()) names.push_back(directive.name);
  return "unknown directive " + Quoted(word) + DidYouMean(word, names);
}

}  // namespace

SceneParser::SceneParser(const SceneParser& importer, std::unique_ptr<Lexer> lexer)
    : builder_(importer.builder_),
      tokens_(std::move(lexer)),
      state_(importer.state_),
      in_world_(true),
      is_import_(true),
      files_above_(importer.files_above_ + importer.tokens_.depth()),
      object_(importer.object_) {}

bool SceneParser::Run() {
  while (true) {
    const Token token = tokens_.Next();
    if (token.kind == Token::Kind::kEnd) return CheckEnd();
    if (!Carry(token)) return false;
  }
}

bool SceneParser::Carry(const Token& token) {
  if (token.kind != Token::Kind::kWord) return Unexpected(token, "a directive");
  Statement statement{nullptr, token.Location()};
  for (const Directive& directive : Directives()) {
    if (directive.name == token.text) statement.directive = &directive;
  }
  if (!statement.directive) {
    if (ParseFloat(token.text)) return Unexpected(token, "a directive");
    return builder_->Fail(statement.location, UnknownDirective(token.text));
  }
  return CheckBlock(statement) && (this->*statement.directive->carry_out)(statement);
}

bool SceneParser::CheckBlock(const Statement& statement) {
  if (statement.directive->block == Block::kWorld && !in_world_) {
    return builder_->Fail(statement.location,
                          statement.name() + " is not allowed here, expected WorldBegin before it");
  }
  if (statement.directive->block == Block::kBeforeWorld && in_world_) {
    return builder_->Fail(statement.location,
                          statement.name() + " is not allowed after WorldBegin, expected it before");
  }
  return true;
}

bool SceneParser::Unexpected(const Token& token, const std::string& expected) {
  if (token.kind == Token::Kind::kBad) return builder_->Fail(token.Location(), std::string(token.text));
  return builder_->Fail(token.Location(),
                        fmt::format("unexpected {}, expected {}", Describe(token), expected));
}

bool SceneParser::ReadString(const Statement& statement, std::string_view what, std::string* out) {
  const Token token = tokens_.Next();
  if (token.kind != Token::Kind::kString) {
    return Unexpected(token, fmt::format("the {} of {} in quotes", what, statement.name()));
  }
  *out = token.text;
  return true;
}

bool SceneParser::ReadName(const Statement& statement, std::string_view what, std::string* out) {
  if (!ReadString(statement, what, out)) return false;
  if (out->size() <= kNameLengthMax) return true;
  return builder_->Fail(statement.location, fmt::format("the {} of {} is longer than {} bytes", what,
                                                        statement.name(), kNameLengthMax));
}

bool SceneParser::ReadNumber(const Statement& statement, size_t index, size_t count, float* out) {
  const Token token = tokens_.Next();
  const std::optional<float> value =
      token.kind == Token::Kind::kWord ? ParseFloat(token.text) : std::optional<float>();
  if (!value) {
    return Unexpected(token, fmt::format("number {} of the {} of {}", index + 1, count, statement.name()));
  }
  *out = *value;
  return true;
}

bool SceneParser::ReadNumbers(const Statement& statement, std::span<float> out) {
  if (tokens_.Peek().kind == Token::Kind::kOpen) {
    return Unexpected(tokens_.Peek(),
                      fmt::format("the {} numbers of {} without brackets", out.size(), statement.name()));
  }
  for (size_t i = 0; i < out.size(); ++i) {
    if (!ReadNumber(statement, i, out.size(), &out[i])) return false;
  }
  return true;
}

bool SceneParser::ReadMatrix(const Statement& statement, Transform* out) {
  const Token open = tokens_.Next();
  if (open.kind != Token::Kind::kOpen) {
    return Unexpected(open, "\"[\" before the 16 numbers of " + statement.name());
  }
  Matrix4 matrix;
  for (size_t i = 0; i < 16; ++i) {
    // Written column by column: the translation comes last.
    if (!ReadNumber(statement, i, 16, &matrix.m[i % 4][i / 4])) return false;
  }
  const Token close = tokens_.Next();
  if (close.kind != Token::Kind::kClose)
    return Unexpected(close, "\"]\" after the 16 numbers of " + statement.name());
  const std::optional<Transform> transform = Transform::FromMatrix(matrix);
  if (!transform)
    return builder_->Fail(statement.location,
                          statement.name() + " has a singular matrix, expected one with an inverse");
  *out = *transform;
  return true;
}

bool SceneParser::ReadEntity(const Statement& statement, Entity* out) {
  out->directive = statement.name();
  out->location = statement.location;
  return ReadName(statement, "kind", &out->kind) && ReadParameters(&out->parameters) &&
         builder_->Charge(*out);
}

bool SceneParser::ReadEntity(const Statement& statement, AttributeTarget target, Entity* out) {
  return ReadEntity(statement, out) && AddAttributes(target, out);
}

bool SceneParser::ReadNamedEntity(const Statement& statement, AttributeTarget target, std::string* name,
                                  Entity* out) {
  out->directive = statement.name();
  out->location = statement.location;
  return ReadName(statement, "name", name) && ReadParameters(&out->parameters) && builder_->Charge(*out) &&
         AddAttributes(target, out) && TakeType(*name, out);
}

bool SceneParser::AddAttributes(AttributeTarget target, Entity* entity) {
  const std::vector<Parameter>& defaults = state_.Attributes(target);
  if (defaults.empty()) return true;
  if (!builder_->ChargeCopy(entity->location, SizeOf(defaults))) return false;
  entity->parameters.insert(entity->parameters.end(), defaults.begin(), defaults.end());
  return true;
}

bool SceneParser::TakeType(const std::string& name, Entity* entity) {
  const Parameter* type = nullptr;
  for (const Parameter& p : entity->parameters) {
    if (p.type != "string" || p.name != "type") continue;
    if (!type || type->from_attribute == p.from_attribute) type = &p;  // explicit ones first, else the last
  }
  if (!type) {
    return builder_->Fail(entity->location,
                          fmt::format("{} {} has no kind, expected a parameter \"string type\"",
                                      entity->directive, Quoted(name)));
  }
  if (type->strings.size() != 1) {
    return builder_->Fail(type->location, fmt::format("\"string type\" of {} {} has {} values, expected 1",
                                                      entity->directive, Quoted(name), type->strings.size()));
  }
  entity->kind = type->strings[0];
  std::erase_if(entity->parameters,
                [](const Parameter& p) { return p.type == "string" && p.name == "type"; });
  return true;
}

}  // namespace tessera
