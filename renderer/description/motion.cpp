#include "renderer/description/motion.h"

#include <fmt/format.h>

#include "renderer/math/flat_transform.h"

namespace tessera {
namespace {

float CameraParameter(const Entity& camera, std::string_view name, float default_value) {
  for (const Parameter& parameter : camera.parameters) {
    if (parameter.name == name && parameter.floats.size() == 1) return parameter.floats[0];
  }
  return default_value;
}

double MiddleOfShutter(const Entity& camera) {
  return (static_cast<double>(CameraParameter(camera, "shutteropen", 0)) +
          static_cast<double>(CameraParameter(camera, "shutterclose", 1))) /
         2;
}

class MotionStopper {
 public:
  MotionStopper(double time_s, Diagnostics& diagnostics) : time_s_(time_s), diagnostics_(diagnostics) {}

  // Between a map and its mirror image there is a moment without volume: what is flat then is not seen.
  void Stop(AnimatedTransform& transform, const SourceLocation& place) {
    if (!transform.IsAnimated()) return;
    ++count_;
    const std::optional<Transform> fixed = transform.At(time_s_);
    if (!fixed) {
      diagnostics_.Warn(place,
                        fmt::format("what moves here has no volume at {} s and is not shown", time_s_));
    }
    transform = AnimatedTransform(fixed ? *fixed : Transform(ZeroMatrix(), ZeroMatrix()));
  }
  // The camera is moved, not the world around it.
  void StopCamera(AnimatedTransform& camera_from_world, const SourceLocation& place) {
    AnimatedTransform world_from_camera = camera_from_world.Inverse();
    if (!world_from_camera.IsAnimated()) return;
    ++count_;
    const std::optional<Transform> fixed = world_from_camera.At(time_s_);
    if (!fixed) {
      error_ = ErrorAt(
          place, fmt::format("the camera has no volume at {} s: the transformations before and after are "
                             "mirror images, expected a motion that can be inverted",
                             time_s_));
      return;
    }
    camera_from_world = AnimatedTransform(fixed->Inverse());
  }
  Result<int> Answer() const {
    if (error_) return *error_;
    return count_;
  }

 private:
  double time_s_;
  Diagnostics& diagnostics_;
  int count_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Result<int> StopMotion(std::optional<double> time_s, SceneDescription& scene) {
  MotionStopper stopper(time_s.value_or(MiddleOfShutter(scene.camera)), scene.diagnostics);
  stopper.StopCamera(scene.camera_from_world, scene.camera.location);
  for (ShapeDescription& shape : scene.shapes) stopper.Stop(shape.world_from_object, shape.entity.location);
  for (ObjectDescription& object : scene.objects) {
    for (ShapeDescription& shape : object.shapes)
      stopper.Stop(shape.world_from_object, shape.entity.location);
  }
  for (InstanceDescription& instance : scene.instances) {
    stopper.Stop(instance.world_from_object, instance.location);
  }
  return stopper.Answer();
}

}  // namespace tessera
