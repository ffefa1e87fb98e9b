#include "renderer/camera/camera_directive.h"

#include <fmt/format.h>

namespace tessera {

ScreenWindow ReadScreenWindow(const CameraDirective& directive) {
  ParameterReader& reader = directive.reader;
  const float aspect = reader.Float("frameaspectratio", static_cast<float>(directive.film.width) /
                                                            static_cast<float>(directive.film.height));
  if (!(aspect > 0)) reader.FailAt("frameaspectratio", "frameaspectratio must be above 0");
  ScreenWindow window =
      aspect > 1 ? ScreenWindow{-aspect, aspect, -1, 1} : ScreenWindow{-1, 1, -1 / aspect, 1 / aspect};
  const std::vector<float> given = reader.Floats("screenwindow");
  if (given.size() == 4)
    window = {given[0], given[1], given[2], given[3]};
  else if (!given.empty())
    directive.diagnostics.Warn(
        reader.LocationOf("screenwindow"),
        fmt::format("screenwindow is ignored: it has {} values, expected x0 x1 y0 y1", given.size()));
  if (window.x0 == window.x1 || window.y0 == window.y1) {
    reader.FailAt("screenwindow",
                  "screenwindow must not be empty: x0 and x1 as well as y0 and y1 must differ");
  }
  return window;
}

Transform RasterFromScreen(const ScreenWindow& window, const CameraFilm& film) {
  const Transform raster_from_ndc =
      Scale(static_cast<float>(film.width), static_cast<float>(-film.height), 1);
  const Transform ndc_from_screen = Scale(1 / (window.x1 - window.x0), 1 / (window.y1 - window.y0), 1) *
                                    Translate({-window.x0, -window.y1, 0});
  return raster_from_ndc * ndc_from_screen;
}

}  // namespace tessera
