// The shape of an aperture stop: how much light passes at each place.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "renderer/camera/camera_directive.h"

namespace tessera {

// Immutable. Copies share the image.
class Aperture {
 public:
  // A circular opening.
  Aperture() = default;
  // A circular opening `factor` times as large as the stop, which no opening of a lens exceeds.
  static Aperture Wide(float factor);

  // Reads "aperture": the name of a built-in shape, or an image file.
  static Aperture Read(const CameraDirective& directive);

  // The weight of light that passes the stop at p, in units of the stop's radius. Its integral is that of the
  // circle, pi, whatever the shape (pbrt's convention, so that the brightness stays).
  float Transmittance(Point2 p) const;

  // Nothing passes farther from the centre, in units of the stop's radius.
  float radius() const { return radius_; }

 private:
  enum class Shape { kCircle, kGaussian, kPolygon, kImage };
  struct Texels {
    int width = 0, height = 0;
    std::vector<float> values;  // rows from top to bottom
  };

  static Aperture Polygon(std::vector<Point2> corners);
  static Aperture OfImage(const CameraDirective& directive, const std::string& file);
  float AtTexel(int x, int y) const;
  float Interpolated(Point2 p) const;

  Shape shape_ = Shape::kCircle;
  float radius_ = 1;
  float polygon_weight_ = 1;
  std::shared_ptr<const std::vector<Point2>> corners_;
  std::shared_ptr<const Texels> texels_;
};

// "gaussian", "square", "pentagon" and "star".
std::vector<std::string_view> ApertureNames();

}  // namespace tessera
