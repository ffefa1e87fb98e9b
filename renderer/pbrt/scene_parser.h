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

#include "renderer/description/description_builder.h"
#include "renderer/pbrt/graphics_state.h"
#include "renderer/pbrt/scene_files.h"
#include "renderer/pbrt/token_stream.h"

namespace tessera {

// Bytes of the Attribute defaults of one target: real ones are few.
constexpr uint64_t kDefaultsSizeMax = 1 << 16;
constexpr size_t kStateDepthMax = 1 << 16;  // open AttributeBegin: real scenes stay below 20

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
  // Of a top-level file. `builder` and `files` must outlive the parser.
  SceneParser(DescriptionBuilder& builder, SceneFiles& files, std::unique_ptr<Lexer> lexer)
      : builder_(&builder), files_(&files), tokens_(std::move(lexer)) {}

  // Reads all. Returns false after an error, which the builder's diagnostics hold, as does every function
  // below; those that read a value return nullopt.
  bool Run();

 private:
  friend struct DirectiveTable;

  // A state to return to, and what opened it.
  struct Pushed {
    GraphicsState state;
    bool is_object;
    SourceLocation location;
  };
  struct NamedEntity {
    std::string name;
    Entity entity;
  };

  SceneParser(const SceneParser& importer, std::unique_ptr<Lexer> lexer);

  bool Fail(const SourceLocation& where, const std::string& message) {
    return builder_->Fail(where, message);
  }
  void Warn(const SourceLocation& where, const std::string& message) {
    builder_->diagnostics().Warn(where, message);
  }

  // ---- Values (scene_parser.cpp, parameter_parser.cpp)
  bool Unexpected(const Token& token, const std::string& expected);
  // `what` of the directive, for messages: "kind".
  std::optional<std::string> ReadString(const Statement& statement, std::string_view what);
  std::optional<std::string> ReadName(const Statement& statement, std::string_view what);
  // Number `index` of `count`.
  std::optional<float> ReadNumber(const Statement& statement, size_t index, size_t count);
  // As many as `numbers` has room for.
  bool ReadNumbers(const Statement& statement, std::span<float> numbers);
  std::optional<Transform> ReadMatrix(const Statement& statement);
  std::optional<std::vector<Parameter>> ReadParameters();
  std::optional<Parameter> ReadParameter();
  std::optional<Parameter> ReadDeclaration(const Token& token);
  // Appends a value.
  bool ReadValue(const Token& token, ValueKind kind, Parameter& parameter);
  // Kind and parameters, followed by the defaults of `target` if there is one.
  std::optional<Entity> ReadEntity(const Statement& statement, std::optional<AttributeTarget> target = {});
  // Name and parameters, of which one is the kind.
  std::optional<NamedEntity> ReadNamedEntity(const Statement& statement, AttributeTarget target);

  bool Carry(const Token& token);
  bool CheckBlock(const Statement& statement);
  bool AddAttributes(AttributeTarget target, Entity& entity);
  // Turns the parameter "string type" into the kind.
  bool TakeType(const std::string& name, Entity& entity);

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
  bool SetTransformTimes(const Statement& statement);
  // The current transform, for what may move.
  AnimatedTransform Moving() const { return transform_times_.Animate(state_.transform); }
  // The current transform, for what does not move: where it is at the start, with a warning if that differs
  // from the end. `what` names it: "light".
  Transform AtRest(const Statement& statement, std::string_view what);

  // ---- What is before WorldBegin, and the order of files and states (structure_directives.cpp)
  bool Option(const Statement& statement);
  bool ReadOptionValue(Parameter& option);
  // One of the entities that a scene has once.
  bool ReadSetting(const Statement& statement, Entity& setting);
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
  bool ObjectInstance(const Statement& statement);

  DescriptionBuilder* builder_;
  SceneFiles* files_;
  TokenStream tokens_;
  GraphicsState state_;
  std::vector<Pushed> pushed_;
  std::map<std::string, TransformPair> coordinate_systems_;
  TransformTimes transform_times_;
  TransformPair camera_from_world_;  // until WorldBegin: TransformTimes may follow the camera
  bool in_world_ = false;
  bool is_import_ = false;
  int files_above_ = 0;           // open files of the parsers that import this one
  std::optional<size_t> object_;  // the object definition that shapes go to
};

}  // namespace tessera
