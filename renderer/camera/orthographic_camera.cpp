#include "renderer/camera/orthographic_camera.h"

namespace tessera {
namespace {

constexpr float kFocusDefault = 1e6f;

}  // namespace

OrthographicCamera OrthographicCamera::Read(const CameraDirective& directive) {
  OrthographicCamera camera;
  camera.lens_ = ThinLens::Read(directive.reader, kFocusDefault);
  const ScreenWindow window = ReadScreenWindow(directive);
  if (!directive.reader.failed())
    camera.camera_from_raster_ = RasterFromScreen(window, directive.film).Inverse();
  return camera;
}

CameraRay OrthographicCamera::GenerateRay(Point2 film, Point2 u_lens) const {
  const Point3 on_film = camera_from_raster_.ToPoint({film.x, film.y, 0});
  if (lens_.is_pinhole()) return {on_film, {0, 0, 1}};
  return lens_.RayThrough(on_film + Vec3{0, 0, lens_.focal_distance}, u_lens);
}

}  // namespace tessera
