#include <fmt/format.h>

#include <cmath>

#include "renderer/math/flat_transform.h"
#include "renderer/pbrt/scene_parser.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

// Factors of zero give a flat map.
Transform ScaleOf(const std::array<float, 3>& factors) {
  if (factors[0] != 0 && factors[1] != 0 && factors[2] != 0) return Scale(factors[0], factors[1], factors[2]);
  Matrix4 matrix;
  for (size_t i = 0; i < 3; ++i) matrix.m[i][i] = factors[i];
  return MapOf(matrix);
}

}  // namespace

bool SceneParser::Concat(const Statement& statement, const std::optional<Transform>& next) {
  if (next && state_.ConcatTransform(*next)) return true;
  return Fail(statement.location, "after " + statement.name() +
                                      " the current transformation is too large for a float, expected "
                                      "finite numbers");
}

bool SceneParser::Identity(const Statement&) {
  return state_.SetTransform(Transform());
}

bool SceneParser::Translate(const Statement& statement) {
  std::array<float, 3> v;
  return ReadNumbers(statement, v) && Concat(statement, tessera::Translate({v[0], v[1], v[2]}));
}

bool SceneParser::Scale(const Statement& statement) {
  std::array<float, 3> v;
  return ReadNumbers(statement, v) && Concat(statement, ScaleOf(v));
}

bool SceneParser::Rotate(const Statement& statement) {
  std::array<float, 4> v;
  if (!ReadNumbers(statement, v)) return false;
  const Vec3 axis{v[1], v[2], v[3]};
  if (v[1] == 0 && v[2] == 0 && v[3] == 0) {
    return Fail(statement.location, "Rotate about the axis 0 0 0, expected a direction");
  }
  return Concat(statement, tessera::Rotate(v[0], axis));
}

bool SceneParser::LookAt(const Statement& statement) {
  std::array<float, 9> v;
  if (!ReadNumbers(statement, v)) return false;
  const std::optional<Transform> look_at =
      tessera::LookAt({v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]});
  if (!look_at) {
    return Fail(statement.location,
                "LookAt has no direction of view, expected two different points and an up vector that is "
                "not parallel to the view");
  }
  return Concat(statement, look_at);
}

bool SceneParser::SetTransform(const Statement& statement) {
  const std::optional<Transform> next = ReadMatrix(statement);
  return next && state_.SetTransform(*next);
}

bool SceneParser::ConcatTransform(const Statement& statement) {
  const std::optional<Transform> next = ReadMatrix(statement);
  return next && Concat(statement, next);
}

bool SceneParser::CoordinateSystem(const Statement& statement) {
  const std::optional<std::string> name = ReadName(statement, "name");
  if (!name) return false;
  coordinate_systems_[*name] = state_.transform;
  return builder_->Charge(statement.location, sizeof(TransformPair) + name->size());
}

bool SceneParser::CoordSysTransform(const Statement& statement) {
  const std::optional<std::string> name = ReadName(statement, "name");
  if (!name) return false;
  const auto found = coordinate_systems_.find(*name);
  if (found != coordinate_systems_.end()) {
    state_.transform = found->second;
  } else {
    Warn(statement.location,
         fmt::format("coordinate system {} is not defined{}: the transformation is unchanged", Quoted(*name),
                     is_import_ ? " in the imported file" : ""));
  }
  return true;
}

bool SceneParser::ActiveTransform(const Statement&) {
  const Token token = tokens_.Next();
  const bool is_word = token.kind == Token::Kind::kWord;
  const bool all = is_word && token.text == "All";
  const bool start = all || (is_word && token.text == "StartTime");
  const bool end = all || (is_word && token.text == "EndTime");
  if (!start && !end) return Unexpected(token, "All, StartTime or EndTime");
  state_.start_is_active = start;
  state_.end_is_active = end;
  return true;
}

bool SceneParser::SetTransformTimes(const Statement& statement) {
  std::array<float, 2> times;
  if (!ReadNumbers(statement, times)) return false;
  transform_times_ = {times[0], times[1]};
  return true;
}

Transform SceneParser::AtRest(const Statement& statement, std::string_view what) {
  if (!(state_.transform.start == state_.transform.end)) {
    Warn(statement.location,
         fmt::format("the {} does not move: the transformation at the start time is used", what));
  }
  if (!IsFlat(state_.transform.start)) return state_.transform.start;
  Warn(statement.location,
       fmt::format("the transformation of the {} has no inverse and is not applied", what));
  return {};
}

}  // namespace tessera
