#include <fmt/format.h>

#include <cctype>

#include "renderer/description/number.h"
#include "renderer/description/option_kinds.h"
#include "renderer/math/flat_transform.h"
#include "renderer/pbrt/scene_parser.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 3> kRenderCoordSys{"camera", "cameraworld", "world"};

// Lower case without '-' and '_'.
std::string Normalized(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if (c != '-' && c != '_') result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return result;
}

}  // namespace

bool SceneParser::Option(const Statement& statement) {
  Parameter option;
  option.location = tokens_.Peek().Location();
  const std::optional<std::string> name = ReadName(statement, "name");
  if (!name) return false;
  option.name = Normalized(*name);
  const Kind<std::string_view>* kind = OptionKinds().Find(option.name);
  if (kind == nullptr) return Fail(option.location, OptionKinds().Refusal(option.name));
  option.type = kind->reader;
  if (!ReadOptionValue(option)) return false;
  if (!builder_->Charge(statement.location, SizeOf(option))) return false;
  builder_->scene().options.push_back(std::move(option));
  return true;
}

bool SceneParser::ReadOptionValue(Parameter& option) {
  const Token token = tokens_.Next();
  const SourceLocation location = token.Location();
  if (!ReadValue(token, ValueKindOf(option.type), option)) return false;
  if (option.type != "string") return true;
  const std::string& value = option.strings[0];
  if (value.empty()) return Fail(location, fmt::format("option \"{}\" is empty", option.name));
  if (option.name != "rendercoordsys") return true;
  for (const std::string_view allowed : kRenderCoordSys) {
    if (value == allowed) return true;
  }
  return Fail(location, fmt::format("unknown coordinate system {}{}, expected one of {}", Quoted(value),
                                    DidYouMean(value, kRenderCoordSys), fmt::join(kRenderCoordSys, " ")));
}

bool SceneParser::Camera(const Statement& statement) {
  std::optional<Entity> camera = ReadEntity(statement);
  if (!camera) return false;
  if (IsFlat(state_.transform.start) || IsFlat(state_.transform.end)) {
    return Fail(
        statement.location,
        "the transformation of the camera has no inverse, expected finite numbers and no scale of zero");
  }
  builder_->scene().camera = *std::move(camera);
  builder_->scene().camera_medium = state_.outside_medium;
  camera_from_world_ = state_.transform;
  coordinate_systems_["camera"] = state_.transform.Inverse();
  return true;
}

bool SceneParser::Film(const Statement& statement) {
  builder_->scene().film_color_space = state_.color_space;
  return ReadSetting(statement, builder_->scene().film);
}

bool SceneParser::PixelFilter(const Statement& statement) {
  return ReadSetting(statement, builder_->scene().filter);
}

bool SceneParser::Sampler(const Statement& statement) {
  return ReadSetting(statement, builder_->scene().sampler);
}

bool SceneParser::Integrator(const Statement& statement) {
  return ReadSetting(statement, builder_->scene().integrator);
}

bool SceneParser::Accelerator(const Statement& statement) {
  return ReadSetting(statement, builder_->scene().accelerator);
}

bool SceneParser::ReadSetting(const Statement& statement, Entity& setting) {
  std::optional<Entity> entity = ReadEntity(statement);
  if (!entity) return false;
  setting = *std::move(entity);
  return true;
}

bool SceneParser::WorldBegin(const Statement&) {
  in_world_ = true;
  builder_->scene().camera_from_world = transform_times_.Animate(camera_from_world_);
  state_.transform = {};
  state_.start_is_active = state_.end_is_active = true;
  coordinate_systems_["world"] = state_.transform;
  return true;
}

std::unique_ptr<Lexer> SceneParser::OpenNamed(const Statement& statement) {
  const SourceLocation location = tokens_.Peek().Location();
  const std::optional<std::string> name = ReadString(statement, "file name");
  if (!name) return nullptr;
  if (files_above_ + tokens_.depth() >= kIncludeDepthMax) {
    Fail(location, fmt::format("{} {}: files nested deeper than {}, does one include itself?",
                               statement.name(), Quoted(*name), kIncludeDepthMax));
    return nullptr;
  }
  return files_->Open(location, statement.name(), *name, builder_->diagnostics());
}

bool SceneParser::Include(const Statement& statement) {
  std::unique_ptr<Lexer> lexer = OpenNamed(statement);
  if (!lexer) return false;
  tokens_.Push(std::move(lexer));
  return true;
}

bool SceneParser::Import(const Statement& statement) {
  std::unique_ptr<Lexer> lexer = OpenNamed(statement);
  if (!lexer) return false;
  SceneParser imported(*this, std::move(lexer));
  return imported.Run();
}

bool SceneParser::Push(const Statement& statement, bool is_object) {
  if (pushed_.size() >= kStateDepthMax) {
    return Fail(statement.location,
                fmt::format("{} nested deeper than {}", statement.name(), kStateDepthMax));
  }
  pushed_.push_back({state_, is_object, statement.location});
  return true;
}

bool SceneParser::Pop(const Statement& statement, bool is_object) {
  const std::string begin = is_object ? "ObjectBegin" : "AttributeBegin";
  if (pushed_.empty()) {
    return Fail(statement.location, fmt::format("{} without {} before it", statement.name(), begin));
  }
  if (pushed_.back().is_object != is_object) {
    return Fail(statement.location,
                fmt::format("{} does not match the {} at {}", statement.name(),
                            is_object ? "AttributeBegin" : "ObjectBegin", pushed_.back().location.Text()));
  }
  state_ = std::move(pushed_.back().state);
  pushed_.pop_back();
  return true;
}

bool SceneParser::AttributeBegin(const Statement& statement) {
  return Push(statement, false);
}

bool SceneParser::AttributeEnd(const Statement& statement) {
  if (pushed_.empty()) {
    Warn(statement.location, statement.name() + " without AttributeBegin before it is ignored");
    return true;
  }
  return Pop(statement, false);
}

bool SceneParser::TransformBegin(const Statement& statement) {
  builder_->diagnostics().WarnOnce(
      "TransformBegin", statement.location,
      "TransformBegin and TransformEnd are deprecated: use AttributeBegin and AttributeEnd");
  return Push(statement, false);
}

bool SceneParser::ObjectBegin(const Statement& statement) {
  std::optional<std::string> name = ReadName(statement, "name");
  if (!name) return false;
  if (object_) {
    return Fail(statement.location,
                fmt::format("ObjectBegin inside the definition of object {}, expected ObjectEnd first",
                            Quoted(builder_->scene().objects[*object_].name)));
  }
  if (!Push(statement, true)) return false;
  if (!builder_->AddObject({*std::move(name), statement.location, {}})) return false;
  object_ = builder_->scene().objects.size() - 1;
  return true;
}

bool SceneParser::ObjectEnd(const Statement& statement) {
  if (!Pop(statement, true)) return false;
  object_.reset();
  return true;
}

bool SceneParser::CheckEnd() {
  const SourceLocation end = tokens_.Peek().Location();
  if (!in_world_) return Fail(end, "the file ends without WorldBegin");
  if (pushed_.empty()) return true;
  return Fail(pushed_.back().location,
              pushed_.back().is_object ? "ObjectBegin without ObjectEnd before the end of the file"
                                       : "AttributeBegin without AttributeEnd before the end of the file");
}

}  // namespace tessera
