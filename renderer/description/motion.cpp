#include "renderer/description/motion.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "renderer/math/motion.h"

namespace tessera {
namespace {

float CameraParameter(const Entity& camera, std::string_view name, float otherwise) {
  for (const Parameter& parameter : camera.parameters) {
    if (parameter.name == name && parameter.floats.size() == 1) return parameter.floats[0];
  }
  return otherwise;
}

double MiddleOfShutter(const Entity& camera) {
  return (static_cast<double>(CameraParameter(camera, "shutteropen", 0)) +
          static_cast<double>(CameraParameter(camera, "shutterclose", 1))) /
         2;
}

// Where `time` lies between the times of the transforms, in [0, 1].
float Fraction(double time, double start, double end) {
  if (time <= start || !(end > start)) return time <= start ? 0 : 1;
  return static_cast<float>(std::min((time - start) / (end - start), 1.0));
}

class MotionStopper {
 public:
  MotionStopper(double time, float fraction) : time_(time), fraction_(fraction) {}

  void Stop(TransformPair& pair, const SourceLocation& place) {
    if (!pair.IsAnimated()) return;
    ++count_;
    const auto between = Interpolate(pair.start, pair.end, fraction_);
    if (between) {
      pair = {*between, *between};
    } else if (!error_) {
      error_ =
          ErrorAt(place, fmt::format("what moves here has no volume at {} s: its transformations at the two "
                                     "times are mirror images, expected a motion that can be inverted",
                                     time_));
    }
  }
  // The camera is moved, not the world around it.
  void StopCamera(TransformPair& camera_from_world, const SourceLocation& place) {
    TransformPair moving{camera_from_world.start.Inverse(), camera_from_world.end.Inverse()};
    if (!camera_from_world.IsAnimated()) return;
    Stop(moving, place);
    camera_from_world = {moving.start.Inverse(), moving.start.Inverse()};
  }
  Result<int> Answer() const {
    if (error_) return *error_;
    return count_;
  }

 private:
  double time_;
  float fraction_;
  int count_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Result<int> StopMotion(std::optional<double> time, SceneDescription* scene) {
  const double moment = time.value_or(MiddleOfShutter(scene->camera));
  MotionStopper stopper(moment, Fraction(moment, scene->shutter_start_time, scene->shutter_end_time));
  stopper.StopCamera(scene->camera_from_world, scene->camera.location);
  for (ShapeDescription& shape : scene->shapes) stopper.Stop(shape.world_from_object, shape.entity.location);
  for (ObjectDescription& object : scene->objects) {
    for (ShapeDescription& shape : object.shapes)
      stopper.Stop(shape.world_from_object, shape.entity.location);
  }
  for (InstanceDescription& instance : scene->instances) {
    stopper.Stop(instance.world_from_object, instance.location);
  }
  return stopper.Answer();
}

}  // namespace tessera
