// Carries out the directives of one scene file and of those it includes. An imported file gets a parser of
// its own with a copy of the graphics state, and the same builder.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/pbrt/graphics_state.h"
#include "renderer/pbrt/scene_builder.h"
#include "renderer/pbrt/token_stream.h"

namespace tessera {

class SceneParser;

// Where a directive may stand.
enum class Block { kAny, kBeforeWorld, kWorld };

struct Directive {
  std::string_view name;
  Block block;
  // Reads the rest of the statement and carries it out. False after an error.
  bool (SceneParser::*carry_out)(const struct Statement&);
};

// How the values of a parameter are written.
enum class ValueKind { kNumber, kInteger, kString, kBool, kSpectrum };
ValueKind ValueKindOf(std::string_view type);

// One use of a directive.
struct Statement {
  const Directive* directive;
  SourceLocation location;
  std::string name() const { return std::string(directive->name); }
};

// In order of name.
std::span<const Directive> Directives();

class SceneParser {
 public:
  // Of a top-level file. `builder` must outlive the parser.
  SceneParser(SceneBuilder& builder, std::unique_ptr<Lexer> lexer)
      : builder_(&builder), tokens_(std::move(lexer)) {}

  // Reads all. False after an error, which the builder has.
  bool Run();

 private:
  friend struct DirectiveTable;

  // A state to return to, and what opened it.
  struct Pushed {
    GraphicsState state;
    bool is_object;
    SourceLocation location;
  };

  SceneParser(const SceneParser& importer, std::unique_ptr<Lexer> lexer);

  // ---- The text: each reads one thing, or fails at its place (scene_parser.cpp)
  bool Unexpected(const Token& token, const std::string& expected);
  // `what` of the directive, for messages: "kind".
  bool ReadString(const Statement& statement, std::string_view what, std::string* out);
  bool ReadName(const Statement& statement, std::string_view what, std::string* out);
  // Number `index` of `count`.
  bool ReadNumber(const Statement& statement, size_t index, size_t count, float* out);
  bool ReadNumbers(const Statement& statement, std::span<float> out);
  bool ReadMatrix(const Statement& statement, Transform* out);
  bool ReadParameters(std::vector<Parameter>* out);  // (parameter_parser.cpp)
  bool ReadParameter(Parameter* out);
  bool ReadDeclaration(const Token& token, Parameter* out);
  bool ReadValue(const Token& token, ValueKind kind, Parameter* parameter);
  // Kind and parameters, with the defaults of `target` behind them.
  bool ReadEntity(const Statement& statement, Entity* out);
  bool ReadEntity(const Statement& statement, AttributeTarget target, Entity* out);
  bool ReadNamedEntity(const Statement& statement, AttributeTarget target, std::string* name, Entity* out);

  bool Carry(const Token& token);
  bool CheckBlock(const Statement& statement);
  bool AddAttributes(AttributeTarget target, Entity* entity);
  bool TakeType(const std::string& name, Entity* entity);

  // ---- Transforms (transform_directives.cpp)
  bool Concat(const Statement& statement, const std::optional<Transform>& next);
  bool Identity(const Statement& statement);
  bool Translate(const Statement& statement);
  bool Scale(const Statement& statement);
  bool Rotate(const Statement& statement);
  bool LookAt(const Statement& statement);
  bool SetTransform(const Statement& statement);
  bool ConcatTransform(const Statement& statement);
  bool CoordinateSystem(const Statement& statement);
  bool CoordSysTransform(const Statement& statement);
  bool ActiveTransform(const Statement& statement);
  bool TransformTimes(const Statement& statement);

  // ---- What is before WorldBegin, and the order of files and states (structure_directives.cpp)
  bool Option(const Statement& statement);
  bool ReadOptionValue(Parameter* option);
  bool Camera(const Statement& statement);
  bool Film(const Statement& statement);
  bool PixelFilter(const Statement& statement);
  bool Sampler(const Statement& statement);
  bool Integrator(const Statement& statement);
  bool Accelerator(const Statement& statement);
  bool WorldBegin(const Statement& statement);
  bool Include(const Statement& statement);
  bool Import(const Statement& statement);
  std::unique_ptr<Lexer> OpenNamed(const Statement& statement);
  bool Push(const Statement& statement, bool is_object);
  bool Pop(const Statement& statement, bool is_object);
  bool AttributeBegin(const Statement& statement);
  bool AttributeEnd(const Statement& statement);
  bool TransformBegin(const Statement& statement);
  bool ObjectBegin(const Statement& statement);
  bool ObjectEnd(const Statement& statement);
  bool CheckEnd();

  // ---- What the world holds (world_directives.cpp)
  bool Attribute(const Statement& statement);
  bool ColorSpace(const Statement& statement);
  bool ReverseOrientation(const Statement& statement);
  bool MediumInterface(const Statement& statement);
  bool MakeNamedMedium(const Statement& statement);
  bool Material(const Statement& statement);
  bool MakeNamedMaterial(const Statement& statement);
  bool NamedMaterial(const Statement& statement);
  bool Texture(const Statement& statement);
  bool LightSource(const Statement& statement);
  bool AreaLightSource(const Statement& statement);
  bool Shape(const Statement& statement);
  bool SetAreaLight(ShapeDescription* shape);
  bool ObjectInstance(const Statement& statement);

  SceneBuilder* builder_;
  TokenStream tokens_;
  GraphicsState state_;
  std::vector<Pushed> pushed_;
  std::map<std::string, TransformPair> coordinate_systems_;
  bool in_world_ = false;
  bool is_import_ = false;
  int files_above_ = 0;           // open files of the parsers that import this one
  std::optional<size_t> object_;  // the object definition that shapes go to
};

}  // namespace tessera
