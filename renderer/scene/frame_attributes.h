// The attributes in a picture's header that depend on which frame of a sequence it is: number, time code, and
// where the camera is. The frames of one animated scene differ in nothing else that a FrameSpec holds.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "renderer/camera/camera.h"
#include "renderer/description/scene_description.h"
#include "renderer/scene/scene.h"

namespace tessera {

// Immutable once built.
class FrameAttributes {
 public:
  FrameAttributes() = default;
  // Of a scene as it was read, before its motion is settled for a frame.
  explicit FrameAttributes(const SceneDescription& scene);
  // For what the kind of camera decides. `width` and `height` of the whole picture, pixels.
  void SetCamera(const Camera& camera, int width, int height);

  // Sets those of the frame that `options` describe:
  //   worldToCamera     the camera looks along z, x is to the right and y up, as in pbrt. Of a camera that
  //                     moves it is that in the middle of the shutter
  //   worldToNDC        to -1 to 1 from left to right and from the bottom to the top of the whole picture;
  //                     of cameras that are projections
  //   pixelAspectRatio  if pixels are not square
  //   frame, framesPerSecond, timeCode   of a sequence
  void Set(const RenderOptions& options, std::map<std::string, std::string>& attributes) const;

 private:
  Matrix4 CameraFromWorld(const RenderOptions& options) const;

  AnimatedTransform world_from_camera_;
  float shutter_open_ = 0, shutter_close_ = 1;  // seconds
  bool has_shutter_ = false;                    // the scene says when it is open
  std::optional<Matrix4> ndc_from_camera_;
  float pixel_aspect_ = 1;  // width of a pixel / its height
};

// "24/1", "24000/1001": frames per second as other programs write them.
std::string FramesPerSecondText(double fps);
// Hours, minutes, seconds and frames; empty if there is none: for negative numbers, or rates that are not
// whole or above 60.
std::string TimeCodeText(int frame, double fps);

}  // namespace tessera
