// Cameras from parameters, for tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "renderer/camera/camera.h"
#include "renderer/image/image.h"
#include "tests/renderer/memory_files.h"

namespace tessera {

inline Parameter FloatParameter(const std::string& name, std::vector<float> values) {
  Parameter parameter;
  parameter.type = "float";
  parameter.name = name;
  parameter.floats = std::move(values);
  return parameter;
}
inline Parameter FloatParameter(const std::string& name, float value) {
  return FloatParameter(name, std::vector<float>{value});
}

inline Parameter StringParameter(const std::string& name, const std::string& value) {
  Parameter parameter;
  parameter.type = "string";
  parameter.name = name;
  parameter.strings = {value};
  return parameter;
}

// What reading a camera gives.
struct ReadCamera {
  Result<Camera> camera;
  std::vector<std::string> warnings;
};

inline ReadCamera TryCamera(const std::string& kind, std::vector<Parameter> parameters,
                            std::map<std::string, std::string> texts = {},
                            const CameraFilm& film = {400, 200}, const Transform& camera_from_world = {}) {
  const Entity entity{"Camera", kind, {}, std::move(parameters)};
  MemoryFiles files(std::move(texts));
  ImageCache images(files);
  Diagnostics diagnostics;
  Result<Camera> camera =
      Camera::Read(entity, AnimatedTransform(camera_from_world), film, images, diagnostics);
  return {std::move(camera), diagnostics.WarningTexts()};
}

inline Camera MakeCamera(const std::string& kind, std::vector<Parameter> parameters,
                         std::map<std::string, std::string> texts = {}, const CameraFilm& film = {400, 200},
                         const Transform& camera_from_world = {}) {
  ReadCamera read = TryCamera(kind, std::move(parameters), std::move(texts), film, camera_from_world);
  EXPECT_TRUE(read.camera) << read.camera.error().message;
  return *read.camera;
}

// Through the middle of the lens.
inline Ray RayAt(const Camera& camera, Point2 film) {
  return camera.GenerateRay(film, {0.5f, 0.5f}, 0).ray;
}

inline void ExpectNear(Vec3 a, Vec3 b, float tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

}  // namespace tessera
