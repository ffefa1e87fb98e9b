#include "renderer/denoise/lost_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer/util/parallel.h"

namespace tessera {
namespace {

// Light is compared in cells of this width and height, and between cells up to kReach away with the weights
// of a Gaussian of one cell.
constexpr int kCell = 16;
constexpr int kCellReach = 2;
constexpr float kCellWeights[kCellReach + 1] = {1, 0.60653f, 0.13534f};

constexpr double kGainMin = 0.8, kGainMax = 1.25;
// Pixels count by their light divided by its root, so that neither bright nor dark ones decide alone.
constexpr double kDarkLight = 1e-3;
// Brighter pixels are errors of the scene.
constexpr double kUsableLightMax = 1e6;

double Luminance(const std::array<double, kColors>& color) {
  return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
}

struct Light {
  double kept = 0, lost = 0;
  double noise = 0;  // variance of `lost`

  void Add(const Light& other, double weight) {
    kept += weight * other.kept;
    lost += weight * other.lost;
    noise += weight * weight * other.noise;
  }
  // What the light is multiplied by. The part of the difference that noise explains is left out, as the
  // estimator of James and Stein does.
  double Gain() const {
    if (kept <= 0 || lost == 0) return 1;
    const double part = lost / kept * std::max(0.0, 1 - noise / (lost * lost));
    return std::clamp(1 + part, kGainMin, kGainMax);
  }
};

class LostLight {
 public:
  LostLight(const LoadedPicture& picture, const InputLayers& layers, std::vector<float>& colors)
      : picture_(picture),
        layers_(layers),
        colors_(colors),
        signals_(kColors + layers.groups.size() * kColors),
        columns_((picture.bounds.width() + kCell - 1) / kCell),
        rows_((picture.bounds.height() + kCell - 1) / kCell),
        cells_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_)),
        gains_(cells_.size()) {}

  void Measure(int row) {
    for (int y = row * kCell; y < std::min((row + 1) * kCell, picture_.bounds.height()); ++y) {
      for (int x = 0; x < picture_.bounds.width(); ++x) cells_[Cell(x / kCell, row)].Add(LightOf(x, y), 1);
    }
  }
  void FindGains(int row) {
    for (int column = 0; column < columns_; ++column) {
      Light around;
      for (int dy = -kCellReach; dy <= kCellReach; ++dy) {
        for (int dx = -kCellReach; dx <= kCellReach; ++dx) {
          const int x = column + dx, y = row + dy;
          if (x < 0 || y < 0 || x >= columns_ || y >= rows_) continue;
          around.Add(cells_[Cell(x, y)], double{kCellWeights[std::abs(dx)] * kCellWeights[std::abs(dy)]});
        }
      }
      gains_[Cell(column, row)] = static_cast<float>(around.Gain());
    }
  }
  void Return(int row) {
    for (int y = row * kCell; y < std::min((row + 1) * kCell, picture_.bounds.height()); ++y) {
      for (int x = 0; x < picture_.bounds.width(); ++x) {
        const float gain = GainAt(x, y);
        float* const color = &colors_[Pixel(x, y) * signals_];
        for (size_t s = 0; s < signals_; ++s) color[s] *= gain;
      }
    }
  }
  int rows() const { return rows_; }

 private:
  size_t Cell(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
  }
  size_t Pixel(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(picture_.bounds.width()) + static_cast<size_t>(x);
  }

  Light LightOf(int x, int y) const {
    const float* const pixel = &picture_.values[Pixel(x, y) * picture_.channels.size()];
    const float* const denoised = &colors_[Pixel(x, y) * signals_];
    std::array<double, kColors> noisy, noise, kept;
    for (size_t c = 0; c < kColors; ++c) {
      const double color = pixel[layers_.color[c]], difference = pixel[layers_.halves[c]];
      const double a = (color + difference) * double{layers_.half_scales[0]},
                   b = (color - difference) * double{layers_.half_scales[1]};
      // Also false if one is not a number.
      if (!(std::abs(a) <= kUsableLightMax && std::abs(b) <= kUsableLightMax)) return {};
      noisy[c] = color;
      noise[c] = 0.5 * (a - b);
      kept[c] = std::max(0.0f, denoised[c]);
    }
    const double light = Luminance(kept);
    const double weight = 1 / std::sqrt(light + kDarkLight);
    const double deviation = weight * Luminance(noise);
    return {weight * light, weight * (Luminance(noisy) - light), deviation * deviation};
  }

  // Between the centres of cells.
  float GainAt(int x, int y) const {
    const float column = (static_cast<float>(x) + 0.5f) / kCell - 0.5f,
                row = (static_cast<float>(y) + 0.5f) / kCell - 0.5f;
    const int x0 = static_cast<int>(std::floor(column)), y0 = static_cast<int>(std::floor(row));
    const float tx = column - static_cast<float>(x0), ty = row - static_cast<float>(y0);
    const auto gain = [&](int cx, int cy) {
      return gains_[Cell(std::clamp(cx, 0, columns_ - 1), std::clamp(cy, 0, rows_ - 1))];
    };
    const float upper = gain(x0, y0) * (1 - tx) + gain(x0 + 1, y0) * tx;
    const float lower = gain(x0, y0 + 1) * (1 - tx) + gain(x0 + 1, y0 + 1) * tx;
    return upper * (1 - ty) + lower * ty;
  }

  const LoadedPicture& picture_;
  const InputLayers& layers_;
  std::vector<float>& colors_;
  const size_t signals_;
  const int columns_, rows_;  // of cells
  std::vector<Light> cells_;
  std::vector<float> gains_;
};

}  // namespace

Result<void> ReturnLostLight(const LoadedPicture& picture, const InputLayers& layers, int threads,
                             const std::stop_token& stop, std::vector<float>& colors) {
  LostLight light(picture, layers, colors);
  const auto for_rows = [&](void (LostLight::*body)(int)) {
    return ForEachItem(static_cast<size_t>(light.rows()), threads, stop,
                       [&](size_t row) { (light.*body)(static_cast<int>(row)); });
  };
  if (auto ok = for_rows(&LostLight::Measure); !ok) return ok;
  if (auto ok = for_rows(&LostLight::FindGains); !ok) return ok;
  return for_rows(&LostLight::Return);
}

}  // namespace tessera
