#include "renderer/light/environment_map.h"

#include "renderer/light/emission.h"
#include "renderer/math/equal_area.h"

namespace tessera {
namespace {

// pbrt-v4's measure of the illuminance of the picture on a plane that faces +z: half of the true value. Used
// here too, so that scenes have the brightness that their authors saw.
float UpwardIlluminance(const RgbImage& image) {
  const float size = static_cast<float>(image.width());
  double sum = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Vec3 w = EqualAreaSquareToSphere(
          {(static_cast<float>(x) + 0.5f) / size, (static_cast<float>(y) + 0.5f) / size});
      if (w.z > 0) sum += static_cast<double>(RelativeLuminance(image.color_space(), image.At(x, y))) * w.z;
    }
  }
  return static_cast<float>(sum) * (2 * kPi / (size * size));
}

}  // namespace

RgbImage ReadEnvironmentMap(ParameterReader& reader, ImageCache& images, Diagnostics& diagnostics) {
  RgbImage image = RgbImage::Read(reader, images, diagnostics);
  if (image.empty() || image.width() == image.height()) return image;
  reader.FailAt("filename",
                "the image is not square; environment maps must be equal-area octahedral (pbrt's imgtool "
                "makeequiarea converts them)");
  return {};
}

float IlluminanceFactor(ParameterReader& reader, const RgbImage& image) {
  const std::optional<float> illuminance = ReadTotal(reader, "illuminance");
  if (!illuminance) return 1;
  const float unit = UpwardIlluminance(image);
  if (unit > 0) return *illuminance / unit;
  reader.FailAt("illuminance", "\"illuminance\" cannot be reached: the upper half of the image is black");
  return 1;
}

}  // namespace tessera
