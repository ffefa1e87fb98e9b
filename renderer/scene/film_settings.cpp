#include "renderer/scene/film_settings.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "renderer/description/parameter_reader.h"

namespace tessera {
namespace {

// Pixel bounds of a crop given as fractions: pixel = ceil(resolution x fraction).
PixelBounds FromFractions(const std::array<float, 4>& f, int width, int height) {
  const auto pixel = [](int resolution, float fraction) {
    return static_cast<int>(std::ceil(static_cast<float>(resolution) * fraction));
  };
  return {pixel(width, f[0]), pixel(height, f[2]), pixel(width, f[1]), pixel(height, f[3])};
}

bool InUnitOrder(const std::array<float, 4>& f) {
  return f[0] >= 0 && f[0] < f[1] && f[1] <= 1 && f[2] >= 0 && f[2] < f[3] && f[3] <= 1;
}

// The scene's own crop: `cropwindow` before `pixelbounds`.
PixelBounds ReadCrop(ParameterReader& reader, const FilmSettings& film) {
  PixelBounds crop{0, 0, film.width, film.height};
  const std::vector<int> bounds = reader.Integers("pixelbounds");
  if (bounds.size() == 4) {
    crop = {std::max(bounds[0], 0), std::max(bounds[2], 0), std::min(bounds[1], film.width),
            std::min(bounds[3], film.height)};
    if (crop.width() <= 0 || crop.height() <= 0) reader.FailAt("pixelbounds", "pixelbounds hold no pixel");
  } else if (!bounds.empty()) {
    reader.FailAt("pixelbounds", "pixelbounds takes 4 integers: x0 x1 y0 y1");
  }
  const std::vector<float> window = reader.Floats("cropwindow");
  if (window.size() == 4) {
    const std::array<float, 4> fractions{window[0], window[1], window[2], window[3]};
    if (InUnitOrder(fractions))
      crop = FromFractions(fractions, film.width, film.height);
    else
      reader.FailAt("cropwindow", "cropwindow must be x0 < x1 and y0 < y1 within 0 and 1");
  } else if (!window.empty()) {
    reader.FailAt("cropwindow", "cropwindow takes 4 numbers: x0 x1 y0 y1");
  }
  return crop;
}

int ReadResolution(ParameterReader& reader, std::string_view name, int default_value,
                   std::optional<int> option) {
  const int value = reader.Integer(name, default_value);
  if (option) return *option;
  if (value < 1 || value > kResolutionMax) {
    reader.FailAt(name, fmt::format("{} must lie between 1 and {}, not {}", name, kResolutionMax, value));
  }
  return value;
}

Result<void> ApplyOptions(const RenderOptions& options, FilmSettings* film) {
  if (film->width < 1 || film->height < 1 || film->width > kResolutionMax || film->height > kResolutionMax) {
    return BadInput(fmt::format("--resolution: {}x{} must lie between 1x1 and {}x{}", film->width,
                                film->height, kResolutionMax, kResolutionMax));
  }
  if (options.crop) {
    if (!InUnitOrder(*options.crop))
      return BadInput("--crop: must be x0,x1,y0,y1 with x0 < x1, y0 < y1 within 0 and 1");
    film->crop = FromFractions(*options.crop, film->width, film->height);
  }
  if (film->crop.width() < 1 || film->crop.height() < 1) return BadInput("the crop holds no pixel");
  if (options.exr_type) film->exr_type = *options.exr_type;
  return {};
}

FilmSettings ReadRgbFilm(ParameterReader& reader, const RenderOptions& options) {
  FilmSettings film;
  reader.String("filename", "");  // the command line names the output
  film.width = ReadResolution(reader, "xresolution", 1280, options.width);
  film.height = ReadResolution(reader, "yresolution", 720, options.height);
  if (!reader.failed()) film.crop = ReadCrop(reader, film);
  reader.Float("diagonal", 35);
  film.iso = reader.Float("iso", 100);
  film.white_balance = reader.Float("whitebalance", 0);
  film.component_max = reader.Float("maxcomponentvalue", std::numeric_limits<float>::infinity());
  film.exr_type = reader.Bool("savefp16", true) ? ExrType::kHalf : ExrType::kFloat;
  const std::string sensor = reader.String("sensor", "cie1931");
  if (sensor != "cie1931")
    reader.FailAt("sensor", "sensor \"" + sensor + "\" is not supported yet: only \"cie1931\" is");
  if (!(film.iso > 0)) reader.FailAt("iso", "iso must be above 0");
  if (film.white_balance < 0 || film.white_balance > 40000) {
    reader.FailAt("whitebalance", "whitebalance must lie between 0 (off) and 40000 kelvin");
  }
  if (!(film.component_max > 0)) reader.FailAt("maxcomponentvalue", "maxcomponentvalue must be above 0");
  return film;
}

using FilmReader = FilmSettings (*)(ParameterReader&, const RenderOptions&);
constexpr Kind<FilmReader> kKinds[] = {
    {"rgb", Support::kSupported, ReadRgbFilm},
    {"gbuffer", Support::kNotSupported},
    {"spectral", Support::kNotSupported},
};
constexpr KindTable<FilmReader> kTable("film", kKinds);

}  // namespace

KindList FilmKinds() {
  return kTable.List();
}

Result<FilmSettings> ReadFilm(const Entity& entity, const RenderOptions& options) {
  const Kind<FilmReader>* kind = kTable.Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, kTable.Refusal(entity.kind));
  ParameterReader reader(entity);
  FilmSettings film = kind->reader(reader, options);
  if (Result<void> done = reader.Finish(); !done) return done.error();
  if (Result<void> applied = ApplyOptions(options, &film); !applied) return applied.error();
  return film;
}

}  // namespace tessera
