#include "renderer/scene/film_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "renderer/description/parameter_reader.h"

namespace tessera {
namespace {

constexpr std::string_view kObserver = "cie1931";

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

// The values of a crop, or nothing with a warning if there are not four.
template <typename T>
std::optional<std::array<T, 4>> FourOf(const std::vector<T>& values, std::string_view name,
                                       const ParameterReader& reader, Diagnostics& diagnostics) {
  if (values.size() == 4) return std::array<T, 4>{values[0], values[1], values[2], values[3]};
  if (!values.empty()) {
    diagnostics.Warn(
        reader.LocationOf(name),
        fmt::format("{0} is ignored: it has {1} values, expected x0 x1 y0 y1", name, values.size()));
  }
  return std::nullopt;
}

// By what --quick divides the width and height of a scene.
int DivisorOf(const RenderOptions& options) {
  constexpr int kQuickDivisor = 4;  // as in pbrt
  return options.quick && !options.width && !options.height ? kQuickDivisor : 1;
}

// In either order, as in pbrt.
template <typename T>
void SortAndClamp(T& low, T& high, T max) {
  if (high < low) std::swap(low, high);
  low = std::clamp(low, T{0}, max);
  high = std::clamp(high, T{0}, max);
}

// Warns if the bounds x0, x1, y0, y1 reach beyond a film of that size.
PixelBounds CropToPixels(const std::array<int, 4>& given, int width, int height,
                         const SourceLocation& location, Diagnostics& diagnostics) {
  std::array<int, 4> v = given;
  SortAndClamp(v[0], v[1], width);
  SortAndClamp(v[2], v[3], height);
  const std::array<int, 4> sorted{std::min(given[0], given[1]), std::max(given[0], given[1]),
                                  std::min(given[2], given[3]), std::max(given[2], given[3])};
  if (v != sorted) diagnostics.Warn(location, "pixelbounds reach beyond the film and are cut at its border");
  return {v[0], v[2], v[1], v[3]};
}

// Divides width and height, and shrinks the crop to the pixels that hold any part of it.
void Shrink(int divisor, FilmSettings* film) {
  const auto shrink = [divisor](int& size, int& low, int& high) {
    size = std::max(1, size / divisor);
    low = std::min(low / divisor, size - 1);
    high = std::min((high + divisor - 1) / divisor, size);
  };
  shrink(film->width, film->crop.x0, film->crop.x1);
  shrink(film->height, film->crop.y0, film->crop.y1);
}

// The scene's own crop: `cropwindow` before `pixelbounds`.
PixelBounds ReadCrop(ParameterReader& reader, const FilmSettings& film, Diagnostics& diagnostics) {
  PixelBounds crop{0, 0, film.width, film.height};
  std::string_view name = "pixelbounds";
  if (const auto bounds = FourOf(reader.Integers("pixelbounds"), "pixelbounds", reader, diagnostics))
    crop = CropToPixels(*bounds, film.width, film.height, reader.LocationOf("pixelbounds"), diagnostics);
  if (auto window = FourOf(reader.Floats("cropwindow"), "cropwindow", reader, diagnostics)) {
    auto& [x0, x1, y0, y1] = *window;
    SortAndClamp(x0, x1, 1.0f);
    SortAndClamp(y0, y1, 1.0f);
    crop = FromFractions(*window, film.width, film.height);
    name = "cropwindow";
  }
  if (crop.width() <= 0 || crop.height() <= 0)
    reader.FailAt(name, fmt::format("the {} holds no pixel", name));
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

Result<void> ApplyOptions(const RenderOptions& options, const SourceLocation& location, FilmSettings* film,
                          Diagnostics& diagnostics) {
  if (film->width < 1 || film->height < 1 || film->width > kResolutionMax || film->height > kResolutionMax) {
    return BadInput(fmt::format("--resolution: {}x{} must lie between 1x1 and {}x{}", film->width,
                                film->height, kResolutionMax, kResolutionMax));
  }
  if (options.crop && options.pixel_bounds)
    return BadInput("--crop and --pixelbounds exclude each other, expected one of them");
  if (options.pixel_bounds)
    film->crop = CropToPixels(*options.pixel_bounds, film->width, film->height, location, diagnostics);
  if (options.crop) {
    if (!InUnitOrder(*options.crop))
      return BadInput("--crop: must be x0,x1,y0,y1 with x0 < x1, y0 < y1 within 0 and 1");
    film->crop = FromFractions(*options.crop, film->width, film->height);
  }
  if (film->crop.width() < 1 || film->crop.height() < 1) return BadInput("the crop holds no pixel");
  if (options.exr_type) film->exr_type = *options.exr_type;
  if (options.cryptomatte_levels) film->cryptomatte_levels = options.cryptomatte_levels;
  return {};
}

// A parameter of ours: what --aov adds.
std::set<std::string> ReadLayers(ParameterReader& reader) {
  const std::vector<std::string_view> known = AovNames();
  std::set<std::string> layers;
  for (const std::string& name : reader.Strings("layers")) {
    if (std::ranges::find(known, name) == known.end()) {
      reader.FailAt("layers", fmt::format("unknown layer {}{}", Quoted(name), DidYouMean(name, known)));
    }
    layers.insert(name);
  }
  return layers;
}

// A parameter of ours, too.
std::optional<uint32_t> ReadCryptomatteLevels(ParameterReader& reader) {
  constexpr const char* kName = "cryptomattelevels";
  const std::optional<int> levels = reader.FindInteger(kName);
  if (!levels) return std::nullopt;
  if (*levels < 1 || *levels > static_cast<int>(kCryptomatteLevelsMax)) {
    reader.FailAt(kName,
                  fmt::format("{} must lie between 1 and {}, not {}", kName, kCryptomatteLevelsMax, *levels));
  }
  return static_cast<uint32_t>(*levels);
}

FilmSettings ReadRgbFilm(ParameterReader& reader, const RenderOptions& options, Diagnostics& diagnostics) {
  FilmSettings film;
  reader.String("filename", "");  // the command line names the output
  film.width = ReadResolution(reader, "xresolution", 1280, options.width);
  film.height = ReadResolution(reader, "yresolution", 720, options.height);
  if (!reader.failed()) {
    film.crop = ReadCrop(reader, film, diagnostics);
    Shrink(DivisorOf(options), &film);
  }
  film.diagonal_mm = reader.Float("diagonal", 35);
  film.iso = reader.Float("iso", 100);
  film.white_balance = reader.Float("whitebalance", 0);
  film.component_max = reader.Float("maxcomponentvalue", std::numeric_limits<float>::infinity());
  film.exr_type = reader.Bool("savefp16", true) ? ExrType::kHalf : ExrType::kFloat;
  std::vector<std::string_view> sensors{kObserver};
  sensors.insert(sensors.end(), SensorNames().begin(), SensorNames().end());
  film.sensor = reader.Choice("sensor", kObserver, sensors);
  film.layers = ReadLayers(reader);
  film.cryptomatte_levels = ReadCryptomatteLevels(reader);
  if (!(film.diagonal_mm > 0)) reader.FailAt("diagonal", "diagonal must be above 0");
  if (!(film.iso > 0)) reader.FailAt("iso", "iso must be above 0");
  if (film.white_balance < 0 || film.white_balance > 40000) {
    reader.FailAt("whitebalance", "whitebalance must lie between 0 (off) and 40000 kelvin");
  }
  if (!(film.component_max > 0)) reader.FailAt("maxcomponentvalue", "maxcomponentvalue must be above 0");
  return film;
}

FilmSettings ReadGbufferFilm(ParameterReader& reader, const RenderOptions& options,
                             Diagnostics& diagnostics) {
  constexpr std::array<std::string_view, 2> kCoordinates = {"camera", "world"};
  const std::string space = reader.Choice("coordinatesystem", kCoordinates[0], kCoordinates);
  FilmSettings film = ReadRgbFilm(reader, options, diagnostics);
  film.gbuffer = space == kCoordinates[0] ? GbufferSpace::kCamera : GbufferSpace::kWorld;
  return film;
}

FilmSettings ReadSpectralFilm(ParameterReader& reader, const RenderOptions& options,
                              Diagnostics& diagnostics) {
  FilmSettings film = ReadRgbFilm(reader, options, diagnostics);
  SpectralBuckets& buckets = film.buckets;
  buckets.first_nm = reader.Float("lambdamin", kLambdaMin);
  buckets.last_nm = reader.Float("lambdamax", kLambdaMax);
  buckets.radiance_max = film.component_max;
  if (!(buckets.first_nm >= kLambdaMin && buckets.first_nm < buckets.last_nm &&
        buckets.last_nm <= kLambdaMax)) {
    reader.FailAt("lambdamin", fmt::format("lambdamin and lambdamax must rise within {} and {} nm",
                                           kLambdaMin, kLambdaMax));
  }
  buckets.count = reader.Integer("nbuckets", 16);
  if (buckets.count < 1 || buckets.count > kSpectralBucketsMax) {
    reader.FailAt("nbuckets", fmt::format("nbuckets must lie between 1 and {}", kSpectralBucketsMax));
  } else if (!buckets.HaveDifferentNames()) {
    reader.FailAt("nbuckets",
                  fmt::format("the {} buckets between lambdamin and lambdamax are too narrow: channels are "
                              "named after their wavelengths in steps of 0.001 nm",
                              buckets.count));
  }
  return film;
}

using FilmReader = FilmSettings (*)(ParameterReader&, const RenderOptions&, Diagnostics&);
constexpr Kind<FilmReader> kKinds[] = {
    {"rgb", Support::kSupported, ReadRgbFilm},
    {"gbuffer", Support::kSupported, ReadGbufferFilm},
    {"spectral", Support::kSupported, ReadSpectralFilm},
};
constexpr KindTable<FilmReader> kTable("film", kKinds);

}  // namespace

FilmSensor FilmSettings::MakeSensor(const ColorSpace& color_space, float exposure_time) const {
  const FilmExposure exposure{exposure_time * iso / 100, component_max};
  if (sensor == kObserver) return FilmSensor::Observer(color_space, exposure, white_balance);
  const std::optional<FilmSensor> measured =
      FilmSensor::Measured(sensor, color_space, exposure, white_balance);
  TESSERA_CHECK(measured.has_value());  // ReadFilm accepts no other name
  return *measured;
}

KindList FilmKinds() {
  return kTable.List();
}

Result<FilmSettings> ReadFilm(const Entity& entity, const RenderOptions& options, Diagnostics& diagnostics) {
  const Kind<FilmReader>* kind = kTable.Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, kTable.Refusal(entity.kind));
  ParameterReader reader(entity);
  FilmSettings film = kind->reader(reader, options, diagnostics);
  if (Result<void> done = reader.Finish(); !done) return done.error();
  if (Result<void> applied = ApplyOptions(options, entity.location, &film, diagnostics); !applied)
    return applied.error();
  return film;
}

}  // namespace tessera
