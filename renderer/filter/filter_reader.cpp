#include "renderer/filter/filter_reader.h"

namespace tessera {
namespace {

constexpr float kRadiusMax = 64;  // pixels: wider filters are mistakes

float ReadRadius(ParameterReader& reader, const char* name, float default_radius) {
  const float radius = reader.Float(name, default_radius);
  if (!(radius > 0 && radius <= kRadiusMax)) {
    reader.FailAt(name, "the filter radius must lie above 0 and at most 64 pixels");
  }
  return radius;
}

}  // namespace

Vec2 ReadRadius(ParameterReader& reader, float default_radius) {
  const float x = ReadRadius(reader, "xradius", default_radius);
  const float y = ReadRadius(reader, "yradius", default_radius);
  return {x, y};
}

}  // namespace tessera
