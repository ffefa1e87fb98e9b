#include "renderer/denoise/temporal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>
#include <vector>

#include "renderer/denoise/denoise.h"
#include "renderer/denoise/strip.h"
#include "renderer/util/parallel.h"

namespace tessera {
namespace {

// Points are the same if their depths differ by less than this part, as the camera may move towards them, and
// the cosine between their normals is above this.
constexpr float kDepthTolerance = 0.1f;
constexpr float kNormalCosineMin = 0.9f;
// Of the four pixels around a point, those of the same surface must have this share of the weight.
constexpr float kSameSurfaceMin = 0.25f;
// Colours may differ by this part of themselves, and by this part of the variance of the noisy ones: what a
// denoised colour is off by.
constexpr float kColorTolerance = 0.03f;
constexpr float kNoiseTolerance = 0.5f;
constexpr float kTinyColor = 1e-4f;

constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();

struct Place {
  float x = kNowhere, y = kNowhere;
};

// The access to one frame by pixel.
class FrameView {
 public:
  explicit FrameView(const DenoisedFrame& frame)
      : frame_(frame),
        width_(frame.picture.bounds.width()),
        height_(frame.picture.bounds.height()),
        signals_((1 + frame.layers.groups.size()) * kColors) {}

  int width() const { return width_; }
  int height() const { return height_; }
  size_t signals() const { return signals_; }
  bool Has(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
  const float* Pixel(int x, int y) const {
    return &frame_.picture.values[Index(x, y) * frame_.picture.channels.size()];
  }
  // The denoised value of a signal, divided by the albedo.
  float Light(int x, int y, size_t signal) const {
    return frame_.colors.values[Index(x, y) * signals_ + signal] / Factor(x, y, signal % kColors);
  }
  float Factor(int x, int y, size_t c) const {
    return AlbedoFactor(UsableAlbedo(Pixel(x, y)[frame_.layers.albedo[c]]));
  }
  float Depth(int x, int y) const { return Pixel(x, y)[frame_.layers.depth]; }
  Place Motion(int x, int y) const {
    const float* const pixel = Pixel(x, y);
    return {pixel[(*frame_.motion)[0]], pixel[(*frame_.motion)[1]]};
  }
  // Whether a pixel of another frame shows the same surface as one of this.
  bool IsSame(int x, int y, const FrameView& other, int other_x, int other_y) const {
    const float *const a = Pixel(x, y), *const b = other.Pixel(other_x, other_y);
    const float depth_a = Depth(x, y), depth_b = other.Depth(other_x, other_y);
    const bool is_far_a = !std::isfinite(depth_a), is_far_b = !std::isfinite(depth_b);
    if (is_far_a || is_far_b) return is_far_a && is_far_b;
    if (!(std::abs(depth_a - depth_b) <= kDepthTolerance * std::max(depth_a, depth_b))) return false;
    float product = 0, square_a = 0, square_b = 0;
    for (size_t c = 0; c < kColors; ++c) {
      const float p = a[frame_.layers.normal[c]], q = b[other.frame_.layers.normal[c]];
      product += p * q;
      square_a += p * p;
      square_b += q * q;
    }
    return product >= kNormalCosineMin * std::sqrt(square_a * square_b);
  }
  // The variance of the noisy light of a pixel, as one estimate of it.
  float Variance(int x, int y, size_t c) const {
    if (!frame_.layers.has_halves) return 0;
    const float difference = Pixel(x, y)[frame_.layers.halves[c]] / Factor(x, y, c);
    return std::isfinite(difference) ? difference * difference : 0;
  }

 private:
  size_t Index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }

  const DenoisedFrame& frame_;
  const int width_, height_;
  const size_t signals_;
};

// Where the points of a frame are in the next one, pixel by pixel.
std::vector<Place> PlacesAfter(const FrameView& frame) {
  std::vector<Place> places;
  places.reserve(static_cast<size_t>(frame.width()) * static_cast<size_t>(frame.height()));
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      const Place motion = frame.Motion(x, y);
      places.push_back({static_cast<float>(x) + motion.x, static_cast<float>(y) + motion.y});
    }
  }
  return places;
}

// Where the points of a frame were in the one before, whose vectors lead to them. Of several, the nearest to
// the camera.
std::vector<Place> PlacesBefore(const FrameView& before) {
  const auto pixels = static_cast<size_t>(before.width()) * static_cast<size_t>(before.height());
  std::vector<Place> places(pixels);
  std::vector<float> depths(pixels, std::numeric_limits<float>::infinity());
  for (int y = 0; y < before.height(); ++y) {
    for (int x = 0; x < before.width(); ++x) {
      const Place motion = before.Motion(x, y);
      const float to_x = std::round(static_cast<float>(x) + motion.x);
      const float to_y = std::round(static_cast<float>(y) + motion.y);
      // False for vectors that are not numbers.
      if (!(to_x >= 0 && to_y >= 0 && to_x < static_cast<float>(before.width()) &&
            to_y < static_cast<float>(before.height())))
        continue;
      const auto pixel =
          static_cast<size_t>(to_y) * static_cast<size_t>(before.width()) + static_cast<size_t>(to_x);
      const bool is_free = std::isnan(places[pixel].x);
      if (!is_free && !(before.Depth(x, y) < depths[pixel])) continue;
      depths[pixel] = before.Depth(x, y);
      places[pixel] = {to_x - motion.x, to_y - motion.y};
    }
  }
  return places;
}

// What a neighbour shows at the places that it has of the points of a frame.
class WarpedFrame {
 public:
  WarpedFrame(const FrameView& frame, const FrameView& neighbour, std::vector<Place> places)
      : frame_(frame),
        neighbour_(neighbour),
        places_(std::move(places)),
        light_(places_.size() * frame.signals()),
        difference_(places_.size(), kNowhere) {}

  void WarpRow(int y) {
    for (int x = 0; x < frame_.width(); ++x) Warp(x, y);
  }
  // The weight of the neighbour at a pixel, relative to that of the frame itself.
  float Weight(int x, int y) const {
    if (std::isnan(difference_[Index(x, y)])) return 0;
    float sum = 0;
    int count = 0;
    ForEachAround(x, y, [&](int i, int j) {
      const float difference = difference_[Index(i, j)];
      if (std::isnan(difference)) return;
      sum += difference;
      ++count;
    });
    const float mean = sum / static_cast<float>(count);
    return 1 / (1 + mean * mean);
  }
  const float* Light(int x, int y) const { return &light_[Index(x, y) * frame_.signals()]; }

 private:
  size_t Index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(frame_.width()) + static_cast<size_t>(x);
  }
  template <typename Body>
  void ForEachAround(int x, int y, const Body& body) const {
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, frame_.height() - 1); ++j) {
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, frame_.width() - 1); ++i) body(i, j);
    }
  }
  void Warp(int x, int y) {
    const Place place = places_[Index(x, y)];
    // False for places that are not numbers.
    if (!(place.x > -1 && place.y > -1 && place.x < static_cast<float>(frame_.width()) &&
          place.y < static_cast<float>(frame_.height())))
      return;
    const int x0 = static_cast<int>(std::floor(place.x)), y0 = static_cast<int>(std::floor(place.y));
    const float right = place.x - static_cast<float>(x0), down = place.y - static_cast<float>(y0);
    float* const light = &light_[Index(x, y) * frame_.signals()];
    float total = 0;
    for (int i = 0; i < 4; ++i) {
      const int px = x0 + i % 2, py = y0 + i / 2;
      const float weight = (i % 2 == 1 ? right : 1 - right) * (i / 2 == 1 ? down : 1 - down);
      if (!neighbour_.Has(px, py) || !frame_.IsSame(x, y, neighbour_, px, py)) continue;
      total += weight;
      for (size_t s = 0; s < frame_.signals(); ++s) light[s] += weight * neighbour_.Light(px, py, s);
    }
    if (!(total >= kSameSurfaceMin)) return;
    for (size_t s = 0; s < frame_.signals(); ++s) light[s] /= total;
    difference_[Index(x, y)] = Difference(x, y, light);
  }
  // The squared difference of the colours, relative to what noise explains.
  float Difference(int x, int y, const float* light) const {
    float largest = 0;
    for (size_t c = 0; c < kColors; ++c) {
      float variance = 0;
      int count = 0;
      ForEachAround(x, y, [&](int i, int j) {
        variance += frame_.Variance(i, j, c);
        ++count;
      });
      const float own = frame_.Light(x, y, c);
      const float tolerance = kColorTolerance * (std::abs(own) + kTinyColor);
      const float explained = tolerance * tolerance + kNoiseTolerance * variance / static_cast<float>(count);
      const float difference = light[c] - own;
      largest = std::max(largest, difference * difference / explained);
    }
    return std::isfinite(largest) ? largest : kNowhere;
  }

  const FrameView& frame_;
  const FrameView& neighbour_;
  const std::vector<Place> places_;
  std::vector<float> light_;
  std::vector<float> difference_;
};

bool HasSameShape(const DenoisedFrame& a, const DenoisedFrame& b) {
  const auto is_same_group = [](const GroupLayer& x, const GroupLayer& y) { return x.name == y.name; };
  return a.layers.has_depth && b.layers.has_depth && a.picture.bounds == b.picture.bounds &&
         std::ranges::equal(a.layers.groups, b.layers.groups, is_same_group);
}

// Returns no values if there is no neighbour to blend with.
Result<std::vector<float>> Blended(const DenoisedFrame* before, const DenoisedFrame& frame,
                                   const DenoisedFrame* after, int threads, const std::stop_token& stop) {
  const FrameView view(frame);
  std::vector<FrameView> neighbours;
  neighbours.reserve(2);  // warped frames refer to them
  std::vector<WarpedFrame> warped;
  if (before != nullptr && before->motion && HasSameShape(*before, frame)) {
    neighbours.emplace_back(*before);
    warped.emplace_back(view, neighbours.back(), PlacesBefore(neighbours.back()));
  }
  if (after != nullptr && frame.motion && HasSameShape(*after, frame)) {
    neighbours.emplace_back(*after);
    warped.emplace_back(view, neighbours.back(), PlacesAfter(view));
  }
  std::vector<float> values;
  if (warped.empty()) return values;
  values = frame.colors.values;
  const auto for_rows = [&](const auto& body) {
    return ForEachItem(static_cast<size_t>(view.height()), threads, stop,
                       [&](size_t y) { body(static_cast<int>(y)); });
  };
  auto done = for_rows([&](int y) {
    for (WarpedFrame& each : warped) each.WarpRow(y);
  });
  if (!done) return done.error();
  done = for_rows([&](int y) {
    float* value = &values[static_cast<size_t>(y) * static_cast<size_t>(view.width()) * view.signals()];
    for (int x = 0; x < view.width(); ++x, value += view.signals()) {
      std::array<float, 2> weights{};
      float total = 1;
      for (size_t i = 0; i < warped.size(); ++i) total += weights[i] = warped[i].Weight(x, y);
      for (size_t s = 0; s < view.signals(); ++s) {
        float sum = view.Light(x, y, s);
        for (size_t i = 0; i < warped.size(); ++i) sum += weights[i] * warped[i].Light(x, y)[s];
        value[s] = sum / total * view.Factor(x, y, s % kColors);
      }
      SettleColors(view.Pixel(x, y), frame.layers, value);
    }
  });
  if (!done) return done.error();
  return values;
}

}  // namespace

Result<LoadedPicture> BlendFrames(const DenoisedFrame* before, const DenoisedFrame& frame,
                                  const DenoisedFrame* after, int threads, const std::stop_token& stop) {
  try {
    auto values = Blended(before, frame, after, threads, stop);
    if (!values) return values.error();
    if (values->empty()) return WithColors(frame.picture, frame.layers, frame.colors);
    return WithColors(frame.picture, frame.layers, {std::move(values).value(), frame.colors.denoiser});
  } catch (const std::bad_alloc&) {
    return Failed("not enough memory to denoise a frame with its neighbours");
  }
}

}  // namespace tessera
