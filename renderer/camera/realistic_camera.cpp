#include "renderer/camera/realistic_camera.h"

#include <fmt/format.h>

#include <cmath>

#include "renderer/image/image.h"

namespace tessera {
namespace {

constexpr size_t kLensFileSizeMax = size_t{1} << 20;  // bytes: far more than the interfaces of any lens
constexpr float kMillimetre = 1e-3f;                  // metres

std::vector<LensInterface> ReadLensFile(const CameraDirective& directive) {
  const std::string name = directive.reader.String("lensfile", "");
  const auto fail = [&](const std::string& problem) -> std::vector<LensInterface> {
    directive.reader.FailAt("lensfile", problem);
    return {};
  };
  if (name.empty()) return fail("the camera needs the file of a lens: \"string lensfile\"");
  const Result<std::string> text = directive.images.files().Read(name);
  if (!text) return fail(text.error().message);
  if (text->size() > kLensFileSizeMax) {
    return fail(fmt::format("lens file \"{}\": {} bytes are more than the {} allowed", name, text->size(),
                            kLensFileSizeMax));
  }
  Result<std::vector<LensInterface>> interfaces = LensSystem::ParseFile(*text);
  if (!interfaces) return fail(fmt::format("lens file \"{}\": {}", name, interfaces.error().message));
  return *std::move(interfaces);
}

void StopDown(const CameraDirective& directive, std::vector<LensInterface>& interfaces) {
  const float diameter_mm = directive.reader.Float("aperturediameter", 1);
  if (!(diameter_mm > 0)) directive.reader.FailAt("aperturediameter", "aperturediameter must be above 0");
  for (LensInterface& stop : interfaces) {
    if (stop.curvature_radius != 0) continue;
    const float diameter = diameter_mm * kMillimetre;
    if (diameter > stop.diameter) {
      directive.diagnostics.Warn(
          directive.reader.LocationOf("aperturediameter"),
          fmt::format("aperturediameter is more than the lens has: {:g} mm instead of {:g} mm",
                      stop.diameter / kMillimetre, diameter_mm));
    } else {
      stop.diameter = diameter;
    }
  }
}

void Focus(const CameraDirective& directive, std::vector<LensInterface>& interfaces) {
  const float distance = directive.reader.Float("focusdistance", 10);
  if (interfaces.empty()) return;
  const std::optional<CardinalPoints> points = LensSystem::FindCardinalPoints(interfaces);
  if (!points) {
    directive.reader.FailAt("lensfile", "the lens does not focus parallel light");
    return;
  }
  const std::optional<double> film_distance = LensSystem::FilmDistance(*points, distance);
  if (!film_distance) {
    directive.reader.FailAt(
        "focusdistance",
        fmt::format("the lens, of {:.4g} mm focal length, cannot focus at {:g} m from the film",
                    points->focal_length / static_cast<double>(kMillimetre), distance));
    return;
  }
  interfaces.back().thickness = static_cast<float>(*film_distance);
}

}  // namespace

RealisticCamera RealisticCamera::Read(const CameraDirective& directive) {
  RealisticCamera camera;
  std::vector<LensInterface> interfaces = ReadLensFile(directive);
  StopDown(directive, interfaces);
  Focus(directive, interfaces);
  const Aperture aperture = Aperture::Read(directive);
  if (directive.reader.failed()) return camera;

  const CameraFilm& film = directive.film;
  camera.picture_width_ = static_cast<float>(film.width);
  camera.picture_height_ = static_cast<float>(film.height);
  const float diagonal = film.diagonal_mm * kMillimetre;
  const float aspect = camera.picture_height_ / camera.picture_width_;
  camera.film_width_ = diagonal / std::sqrt(1 + aspect * aspect);
  camera.film_height_ = aspect * camera.film_width_;
  const LensSystem lens(interfaces);
  camera.optics_ = std::make_shared<const Optics>(
      Optics{lens, aperture, ExitPupil(lens, aperture.radius(), diagonal / 2)});
  return camera;
}

CameraRay RealisticCamera::GenerateRay(Point2 film, Point2 u_lens) const {
  constexpr CameraRay kNoLight{{0, 0, 0}, {0, 0, 1}, 0};
  // A lens turns the picture upside down and left to right.
  const Point3 o{(0.5f - film.x / picture_width_) * film_width_,
                 (film.y / picture_height_ - 0.5f) * film_height_, 0};
  const std::optional<PupilSample> pupil = optics_->pupil.Sample({o.x, o.y}, u_lens);
  if (!pupil) return kNoLight;
  const float rear_z = optics_->lens.rear_z();
  const Vec3 d = Normalize(Vec3{pupil->p.x, pupil->p.y, rear_z} - o);
  std::optional<CameraRay> ray = optics_->lens.Trace(o, d, optics_->aperture);
  if (!ray) return kNoLight;
  // The two cosines over the square of the distance, times the area: Kolb et al. 1995, equation 3.
  ray->weight *= Sqr(Sqr(d.z)) * pupil->area / Sqr(rear_z);
  return *ray;
}

}  // namespace tessera
