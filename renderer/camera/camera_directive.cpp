#include "renderer/camera/camera_directive.h"

namespace tessera {

ScreenWindow ReadScreenWindow(const CameraDirective& directive) {
  ParameterReader& reader = directive.reader;
  const float aspect = reader.Float(
      "frameaspectratio", static_cast<float>(directive.width) / static_cast<float>(directive.height));
  if (!(aspect > 0)) reader.FailAt("frameaspectratio", "frameaspectratio must be above 0");
  ScreenWindow window =
      aspect > 1 ? ScreenWindow{-aspect, aspect, -1, 1} : ScreenWindow{-1, 1, -1 / aspect, 1 / aspect};
  const std::vector<float> given = reader.Floats("screenwindow");
  if (given.size() == 4)
    window = {given[0], given[1], given[2], given[3]};
  else if (!given.empty())
    reader.FailAt("screenwindow", "screenwindow takes 4 numbers: x0 x1 y0 y1");
  if (!(window.x0 < window.x1 && window.y0 < window.y1)) {
    reader.FailAt("screenwindow", "screenwindow must have x0 < x1 and y0 < y1");
  }
  return window;
}

}  // namespace tessera
