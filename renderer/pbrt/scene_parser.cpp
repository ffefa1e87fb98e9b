#include "renderer/pbrt/scene_parser.h"

#include <fmt/format.h>

#include "renderer/description/number.h"
#include "renderer/math/flat_transform.h"
#include "renderer/text/unicode.h"
#include "renderer/util/load_budget.h"
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

// Also explains a word that is a directive in other versions of the language.
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
      files_(importer.files_),
      tokens_(std::move(lexer)),
      state_(importer.state_),
      transform_times_(importer.transform_times_),
      in_world_(true),
      is_import_(true),
      files_above_(importer.files_above_ + importer.tokens_.depth()),
      object_(importer.object_) {}

bool SceneParser::Run() {
  while (true) {
    CheckLoadBudget();
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
    return Fail(statement.location, UnknownDirective(token.text));
  }
  return CheckBlock(statement) && (this->*statement.directive->carry_out)(statement);
}

bool SceneParser::CheckBlock(const Statement& statement) {
  if (statement.directive->block == Block::kWorld && !in_world_) {
    return Fail(statement.location, statement.name() + " is not allowed here, expected WorldBegin before it");
  }
  if (statement.directive->block == Block::kBeforeWorld && in_world_) {
    return Fail(statement.location,
                statement.name() + " is not allowed after WorldBegin, expected it before");
  }
  return true;
}

bool SceneParser::Unexpected(const Token& token, const std::string& expected) {
  if (token.kind == Token::Kind::kBad) return Fail(token.Location(), std::string(token.text));
  return Fail(token.Location(), fmt::format("unexpected {}, expected {}", Describe(token), expected));
}

std::optional<std::string> SceneParser::ReadString(const Statement& statement, std::string_view what) {
  const Token token = tokens_.Next();
  if (token.kind == Token::Kind::kString) return std::string(token.text);
  Unexpected(token, fmt::format("the {} of {} in quotes", what, statement.name()));
  return std::nullopt;
}

std::optional<std::string> SceneParser::ReadName(const Statement& statement, std::string_view what) {
  std::optional<std::string> name = ReadString(statement, what);
  if (name) name = Normalize(*name);
  if (!name || name->size() <= kNameLengthMax) return name;
  Fail(statement.location,
       fmt::format("the {} of {} is longer than {} bytes", what, statement.name(), kNameLengthMax));
  return std::nullopt;
}

std::optional<float> SceneParser::ReadNumber(const Statement& statement, size_t index, size_t count) {
  const Token token = tokens_.Next();
  const std::optional<float> value =
      token.kind == Token::Kind::kWord ? ParseFloat(token.text) : std::optional<float>();
  if (!value) Unexpected(token, fmt::format("number {} of the {} of {}", index + 1, count, statement.name()));
  return value;
}

bool SceneParser::ReadNumbers(const Statement& statement, std::span<float> numbers) {
  if (tokens_.Peek().kind == Token::Kind::kOpen) {
    return Unexpected(tokens_.Peek(),
                      fmt::format("the {} numbers of {} without brackets", numbers.size(), statement.name()));
  }
  for (size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<float> number = ReadNumber(statement, i, numbers.size());
    if (!number) return false;
    numbers[i] = *number;
  }
  return true;
}

std::optional<Transform> SceneParser::ReadMatrix(const Statement& statement) {
  const Token open = tokens_.Next();
  if (open.kind != Token::Kind::kOpen) {
    Unexpected(open, "\"[\" before the 16 numbers of " + statement.name());
    return std::nullopt;
  }
  Matrix4 matrix;
  for (size_t i = 0; i < 16; ++i) {
    const std::optional<float> number = ReadNumber(statement, i, 16);
    if (!number) return std::nullopt;
    // Written column by column: the translation comes last.
    matrix.m[i % 4][i / 4] = *number;
  }
  const Token close = tokens_.Next();
  if (close.kind != Token::Kind::kClose) {
    Unexpected(close, "\"]\" after the 16 numbers of " + statement.name());
    return std::nullopt;
  }
  return MapOf(matrix);
}

std::optional<Entity> SceneParser::ReadEntity(const Statement& statement,
                                              std::optional<AttributeTarget> target) {
  std::optional<std::string> kind = ReadName(statement, "kind");
  if (!kind) return std::nullopt;
  std::optional<std::vector<Parameter>> parameters = ReadParameters();
  if (!parameters) return std::nullopt;
  Entity entity{statement.name(), *std::move(kind), statement.location, *std::move(parameters)};
  if (!builder_->Charge(entity) || (target && !AddAttributes(*target, entity))) return std::nullopt;
  return entity;
}

std::optional<SceneParser::NamedEntity> SceneParser::ReadNamedEntity(const Statement& statement,
                                                                     AttributeTarget target) {
  std::optional<std::string> name = ReadName(statement, "name");
  if (!name) return std::nullopt;
  std::optional<std::vector<Parameter>> parameters = ReadParameters();
  if (!parameters) return std::nullopt;
  NamedEntity named{*std::move(name), {statement.name(), "", statement.location, *std::move(parameters)}};
  if (!builder_->Charge(named.entity) || !AddAttributes(target, named.entity) ||
      !TakeType(named.name, named.entity)) {
    return std::nullopt;
  }
  return named;
}

bool SceneParser::AddAttributes(AttributeTarget target, Entity& entity) {
  const std::vector<Parameter>& defaults = state_.Attributes(target);
  if (defaults.empty()) return true;
  if (!builder_->ChargeCopy(entity.location, SizeOf(defaults))) return false;
  entity.parameters.insert(entity.parameters.end(), defaults.begin(), defaults.end());
  return true;
}

bool SceneParser::TakeType(const std::string& name, Entity& entity) {
  const Parameter* type = nullptr;
  for (const Parameter& p : entity.parameters) {
    if (p.type != "string" || p.name != "type") continue;
    if (!type || type->is_default == p.is_default) type = &p;  // written ones first, else the last
  }
  if (!type) {
    return Fail(entity.location, fmt::format("{} {} has no kind, expected a parameter \"string type\"",
                                             entity.directive, Quoted(name)));
  }
  if (type->strings.size() != 1) {
    return Fail(type->location, fmt::format("\"string type\" of {} {} has {} values, expected 1",
                                            entity.directive, Quoted(name), type->strings.size()));
  }
  entity.kind = type->strings[0];
  std::erase_if(entity.parameters, [](const Parameter& p) { return p.type == "string" && p.name == "type"; });
  return true;
}

}  // namespace tessera
