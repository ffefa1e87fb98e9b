#include "renderer/camera/aperture.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "renderer/image/image.h"

namespace tessera {
namespace {

// `count` corners on a circle, the first one below the centre.
std::vector<Point2> RegularPolygon(int count, float radius) {
  std::vector<Point2> corners;
  for (int i = 0; i < count; ++i) {
    const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(count) - kPi / 2;
    corners.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return corners;
}

// A pentagram: the outer corners lie on the unit circle, one of them at (-1, 0).
std::vector<Point2> Star() {
  std::vector<Point2> corners;
  const float inner = std::cos(Radians(72.0f)) / std::cos(Radians(36.0f));
  for (int i = 0; i < 10; ++i) {
    const float radius = i % 2 == 1 ? 1 : inner;
    const float angle = kPi * static_cast<float>(i) / 5;
    corners.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return corners;
}

// Of corners in counterclockwise order.
double Area(const std::vector<Point2>& corners) {
  double twice = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Point2 a = corners[i], b = corners[(i + 1) % corners.size()];
    twice += static_cast<double>(a.x) * b.y - static_cast<double>(b.x) * a.y;
  }
  return twice / 2;
}

// Whether a ray to the right crosses the outline an odd number of times.
bool IsInside(const std::vector<Point2>& corners, Point2 p) {
  bool inside = false;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Point2 a = corners[i], b = corners[(i + 1) % corners.size()];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    if (p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

constexpr float kSquareHalfSide = 0.5f;
constexpr float kPentagonRadius = 0.8f;

// A gaussian of exp(-r^2) less its value at the edge. Its integral over the unit disk is pi (1 - 2 / e).
constexpr float kGaussianAtEdge = static_cast<float>(1 / std::numbers::e);
constexpr float kGaussianWeight = static_cast<float>(1 / (1 - 2 / std::numbers::e));

}  // namespace

std::vector<std::string_view> ApertureNames() {
  return {"gaussian", "square", "pentagon", "star"};
}

Aperture Aperture::Wide(float factor) {
  Aperture aperture;
  aperture.radius_ = factor;
  return aperture;
}

Aperture Aperture::Polygon(std::vector<Point2> corners) {
  Aperture aperture;
  aperture.shape_ = Shape::kPolygon;
  aperture.polygon_weight_ = static_cast<float>(std::numbers::pi / Area(corners));
  aperture.corners_ = std::make_shared<const std::vector<Point2>>(std::move(corners));
  return aperture;
}

Aperture Aperture::OfImage(const CameraDirective& directive, const std::string& file) {
  const Result<std::shared_ptr<const Image>> image = directive.images.Get(file, std::nullopt);
  const auto fail = [&](const std::string& problem) {
    directive.reader.FailAt("aperture", problem);
    return Aperture();
  };
  if (!image) {
    return fail(
        fmt::format("aperture \"{}\" is neither gaussian, square, pentagon or star nor a readable image: {}",
                    file, image.error().message));
  }
  const Image& picture = **image;
  std::vector<int> channels = {0};
  if (picture.channels > 1) {
    const auto rgb = picture.RgbChannels();
    if (!rgb) return fail(fmt::format("aperture image \"{}\" has no channels R, G and B", file));
    channels.assign(rgb->begin(), rgb->end());
  }
  Texels texels{picture.width, picture.height, {}};
  double sum = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      float value = 0;
      for (int channel : channels) value += picture.Get(x, y, channel) / static_cast<float>(channels.size());
      if (!(value >= 0) || std::isinf(value))
        return fail(fmt::format("aperture image \"{}\" has values that are negative or not finite", file));
      texels.values.push_back(value);
      sum += value;
    }
  }
  if (!(sum > 0)) return fail(fmt::format("aperture image \"{}\" is black", file));
  const double scale = std::numbers::pi / 4 * static_cast<double>(texels.values.size()) / sum;
  for (float& value : texels.values) value = static_cast<float>(value * scale);
  Aperture aperture;
  aperture.shape_ = Shape::kImage;
  aperture.radius_ = std::numbers::sqrt2_v<float>;  // the image fills the square around the stop
  aperture.texels_ = std::make_shared<const Texels>(std::move(texels));
  return aperture;
}

Aperture Aperture::Read(const CameraDirective& directive) {
  const std::string name = directive.reader.String("aperture", "");
  if (name.empty()) return {};
  if (name == "gaussian") {
    Aperture aperture;
    aperture.shape_ = Shape::kGaussian;
    return aperture;
  }
  if (name == "square") {
    constexpr float kHalf = kSquareHalfSide;
    return Polygon({{-kHalf, -kHalf}, {kHalf, -kHalf}, {kHalf, kHalf}, {-kHalf, kHalf}});
  }
  if (name == "pentagon") return Polygon(RegularPolygon(5, kPentagonRadius));
  if (name == "star") return Polygon(Star());
  return OfImage(directive, name);
}

float Aperture::Transmittance(Point2 p) const {
  const float r2 = p.x * p.x + p.y * p.y;
  if (!(r2 <= radius_ * radius_)) return 0;
  switch (shape_) {
    case Shape::kCircle: return 1;
    case Shape::kGaussian: return kGaussianWeight * std::max(0.0f, std::exp(-r2) - kGaussianAtEdge);
    case Shape::kPolygon: return IsInside(*corners_, p) ? polygon_weight_ : 0;
    case Shape::kImage: return Interpolated(p);
  }
  return 0;
}

float Aperture::AtTexel(int x, int y) const {
  if (x < 0 || y < 0 || x >= texels_->width || y >= texels_->height) return 0;
  return texels_
      ->values[static_cast<size_t>(y) * static_cast<size_t>(texels_->width) + static_cast<size_t>(x)];
}

// Bilinear, black outside.
float Aperture::Interpolated(Point2 p) const {
  const float x = (p.x + 1) / 2 * static_cast<float>(texels_->width) - 0.5f;
  const float y = (1 - p.y) / 2 * static_cast<float>(texels_->height) - 0.5f;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const float tx = x - static_cast<float>(x0), ty = y - static_cast<float>(y0);
  return Lerp(ty, Lerp(tx, AtTexel(x0, y0), AtTexel(x0 + 1, y0)),
              Lerp(tx, AtTexel(x0, y0 + 1), AtTexel(x0 + 1, y0 + 1)));
}

}  // namespace tessera
