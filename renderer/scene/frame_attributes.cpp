#include "renderer/scene/frame_attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "renderer/description/parameter_reader.h"

namespace tessera {
namespace {

// As OpenEXR has it: for row vectors.
std::string MatrixText(const Matrix4& columns) {
  std::string text;
  for (size_t row = 0; row < 4; ++row) {
    for (size_t column = 0; column < 4; ++column)
      text += fmt::format("{}{}", text.empty() ? "" : " ", columns.m[column][row]);
  }
  return text;
}

bool AllFinite(const Matrix4& matrix) {
  return std::ranges::all_of(matrix.m, [](const auto& row) {
    return std::ranges::all_of(row, [](float x) { return std::isfinite(x); });
  });
}

}  // namespace

FrameAttributes::FrameAttributes(const SceneDescription& scene)
    : world_from_camera_(scene.camera_from_world.Inverse()) {
  ParameterReader reader(scene.camera);
  has_shutter_ = reader.Has("shutteropen") || reader.Has("shutterclose");
  shutter_open_ = reader.Float("shutteropen", 0);
  shutter_close_ = reader.Float("shutterclose", 1);
}

void FrameAttributes::SetCamera(const Camera& camera, int width, int height) {
  const std::optional<Transform> raster_from_camera = camera.raster_from_camera();
  if (!raster_from_camera) return;
  const Matrix4& raster = raster_from_camera->matrix();
  const Transform ndc_from_raster =
      Translate({-1, 1, 0}) * Scale(2 / static_cast<float>(width), -2 / static_cast<float>(height), 1);
  const Matrix4 ndc = ndc_from_raster.matrix() * raster;
  if (AllFinite(ndc)) ndc_from_camera_ = ndc;
  const float aspect = std::abs(raster.m[1][1] / raster.m[0][0]);
  constexpr float kSquare = 1e-3f;                        // aspect ratios are often written with few digits
  constexpr float kAspectMin = 1e-6f, kAspectMax = 1e6f;  // OpenEXR writes no picture with another
  if (aspect >= kAspectMin && aspect <= kAspectMax && std::abs(aspect - 1) > kSquare) pixel_aspect_ = aspect;
}

Matrix4 FrameAttributes::CameraFromWorld(const RenderOptions& options) const {
  // Without times of a shutter, a frame of a sequence is a single moment.
  const double middle_s = (static_cast<double>(shutter_open_) + static_cast<double>(shutter_close_)) / 2;
  const double time_s = options.time.value_or(0) + (options.time && !has_shutter_ ? 0 : middle_s);
  return world_from_camera_.At(time_s).value_or(world_from_camera_.First()).Inverse().matrix();
}

void FrameAttributes::Set(const RenderOptions& options,
                          std::map<std::string, std::string>& attributes) const {
  const Matrix4 camera_from_world = CameraFromWorld(options);
  if (AllFinite(camera_from_world)) {
    attributes["worldToCamera"] = MatrixText(camera_from_world);
    if (ndc_from_camera_) {
      const Matrix4 ndc = *ndc_from_camera_ * camera_from_world;
      if (AllFinite(ndc)) attributes["worldToNDC"] = MatrixText(ndc);
    }
  }
  if (pixel_aspect_ != 1) attributes["pixelAspectRatio"] = fmt::format("{}", pixel_aspect_);
  if (!options.frame) return;
  attributes["frame"] = fmt::format("{}", *options.frame);
  if (!options.frames_per_second) return;
  attributes["framesPerSecond"] = FramesPerSecondText(*options.frames_per_second);
  const std::string code = TimeCodeText(*options.frame, *options.frames_per_second);
  if (!code.empty()) attributes["timeCode"] = code;
}

std::string FramesPerSecondText(double fps) {
  constexpr double kTolerance = 5e-4;  // 23.976 stands for 24000/1001
  fps = std::clamp(fps, 0.001, 2e6);   // both parts fit into 32 bits
  const double whole = std::round(fps), ntsc = std::round(fps * 1.001);
  if (std::abs(fps - whole) < kTolerance && whole >= 1) return fmt::format("{:.0f}/1", whole);
  if (std::abs(fps * 1.001 - ntsc) < 1e-3 && ntsc >= 1) return fmt::format("{:.0f}/1001", ntsc * 1000);
  return fmt::format("{:.0f}/1000", std::round(fps * 1000));
}

std::string TimeCodeText(int frame, double fps) {
  constexpr int kRateMax = 60;
  if (frame < 0 || fps != std::round(fps) || fps < 1 || fps > kRateMax) return "";
  const int rate = static_cast<int>(fps), seconds = frame / rate;
  return fmt::format("{:02}:{:02}:{:02}:{:02}", seconds / 3600 % 24, seconds / 60 % 60, seconds % 60,
                     frame % rate);
}

}  // namespace tessera
