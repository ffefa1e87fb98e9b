#include "renderer/description/motion.h"

#include <fmt/format.h>

#include "renderer/math/flat_transform.h"

namespace tessera {
namespace {

// Calls visit(transform, location) for all transforms that may move, but not for the camera's.
template <typename Scene, typename Visit>
void ForEachPlaced(Scene& scene, const Visit& visit) {
  for (auto& shape : scene.shapes) visit(shape.world_from_object, shape.entity.location);
  for (auto& object : scene.objects) {
    for (auto& shape : object.shapes) visit(shape.world_from_object, shape.entity.location);
  }
  for (auto& instance : scene.instances) visit(instance.world_from_object, instance.location);
  for (auto& light : scene.lights) visit(light.world_from_light, light.entity.location);
}

bool IsAffine(const Transform& transform) {
  return transform.matrix().m[3] == std::array<float, 4>{0, 0, 0, 1};
}

class MotionChecker {
 public:
  void Check(const AnimatedTransform& transform, const SourceLocation& place) {
    if (!transform.IsAnimated()) return;
    ++count_;
    const auto is_affine = [](const TransformKey& key) { return IsAffine(key.transform); };
    if (!error_ && !std::ranges::all_of(transform.keys(), is_affine)) {
      error_ = ErrorAt(place, "what moves has a projective transformation, expected an affine one");
    }
  }
  // Between a map and its mirror image there is a moment without volume.
  void CheckCamera(const AnimatedTransform& transform, const SourceLocation& place) {
    Check(transform, place);
    const auto is_mirrored = [&](const TransformKey& key) {
      return key.transform.SwapsHandedness() != transform.First().SwapsHandedness();
    };
    if (!error_ && std::ranges::any_of(transform.keys(), is_mirrored)) {
      error_ =
          ErrorAt(place,
                  "the camera turns into its mirror image, expected a motion that can be inverted at all "
                  "times");
    }
  }
  Result<int> Count() const {
    if (error_) return *error_;
    return count_;
  }

 private:
  int count_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Result<int> CheckMotion(const SceneDescription& scene) {
  MotionChecker checker;
  checker.CheckCamera(scene.camera_from_world, scene.camera.location);
  ForEachPlaced(scene, [&checker](const AnimatedTransform& transform, const SourceLocation& place) {
    checker.Check(transform, place);
  });
  return checker.Count();
}

void StartTimeAt(double time_s, SceneDescription& scene) {
  scene.camera_from_world = scene.camera_from_world.Delayed(-time_s);
  ForEachPlaced(scene, [time_s](AnimatedTransform& transform, const SourceLocation&) {
    transform = transform.Delayed(-time_s);
  });
}

Result<void> StopMotion(double time_s, SceneDescription& scene) {
  if (scene.camera_from_world.IsAnimated()) {
    // The camera moves, not the world around it.
    const std::optional<Transform> fixed = scene.camera_from_world.Inverse().At(time_s);
    if (!fixed) {
      return ErrorAt(
          scene.camera.location,
          fmt::format("the camera has no volume at {} s, expected a motion that can be inverted", time_s));
    }
    scene.camera_from_world = AnimatedTransform(fixed->Inverse());
  }
  ForEachPlaced(scene, [&](AnimatedTransform& transform, const SourceLocation& place) {
    if (!transform.IsAnimated()) return;
    const std::optional<Transform> fixed = transform.At(time_s);
    if (!fixed) {
      scene.diagnostics.Warn(place,
                             fmt::format("what moves here has no volume at {} s and is not shown", time_s));
    }
    transform = AnimatedTransform(fixed ? *fixed : Transform(ZeroMatrix(), ZeroMatrix()));
  });
  std::erase_if(scene.lights,
                [](const LightDescription& light) { return IsFlat(light.world_from_light.Fixed()); });
  return {};
}

}  // namespace tessera
