#include "renderer/denoise/temporal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "renderer/denoise/denoise.h"
#include "tests/renderer/denoise/noisy_picture.h"

namespace tessera {
namespace {

constexpr int kWide = 80, kHigh = 60;
constexpr float kRight = 2.5f, kDown = 1;  // pixels that everything moves from frame to frame

// A textured plane under light that varies slowly, both moving with the plane.
Point Panning(int frame, int x, int y) {
  const float u = static_cast<float>(x) - kRight * static_cast<float>(frame);
  const float v = static_cast<float>(y) - kDown * static_cast<float>(frame);
  const bool is_dark = (static_cast<int>(std::floor(u / 5)) + static_cast<int>(std::floor(v / 4))) % 2 == 0;
  return {1.5f + 0.5f * std::sin(u / 17), is_dark ? 0.2f : 0.7f, 0, 4};
}

using Paint = Point (*)(int frame, int x, int y);
using Motion = std::array<float, 2> (*)(int frame, int x, int y);

std::array<float, 2> Pan(int, int, int) {
  return {kRight, kDown};
}
std::array<float, 2> Still(int, int, int) {
  return {0, 0};
}

PaintPoint At(Paint paint, int frame) {
  return [=](int x, int y) { return paint(frame, x, y); };
}

LoadedPicture FrameOf(int frame, Paint paint, Motion motion, float noise = 0.6f) {
  const LoadedPicture still = Rendered(kWide, kHigh, noise, At(paint, frame), 10 + frame);
  LoadedPicture moving = still;
  moving.channels.insert(moving.channels.end(), {"motion.X", "motion.Y"});
  moving.values.clear();
  for (size_t i = 0; i < still.values.size(); i += still.channels.size()) {
    const auto pixel = static_cast<int>(i / still.channels.size());
    moving.values.insert(moving.values.end(), still.values.begin() + static_cast<ptrdiff_t>(i),
                         still.values.begin() + static_cast<ptrdiff_t>(i + still.channels.size()));
    for (const float part : motion(frame, pixel % kWide, pixel / kWide)) moving.values.push_back(part);
  }
  return moving;
}

DenoisedFrame Alone(const LoadedPicture& picture) {
  auto frame = DenoiseAlone(picture, "f.exr", 2, {}, Denoiser::kRegression);
  EXPECT_TRUE(frame) << frame.error().message;
  return std::move(frame).value();
}

// Frames denoised alone and with their neighbours.
struct Sequence {
  std::vector<LoadedPicture> alone, blended;
};

Sequence DenoiseAll(int count, Paint paint, Motion motion) {
  std::vector<DenoisedFrame> frames;
  for (int f = 0; f < count; ++f) frames.push_back(Alone(FrameOf(f, paint, motion)));
  Sequence result;
  for (size_t f = 0; f < frames.size(); ++f) {
    const DenoisedFrame* const before = f > 0 ? &frames[f - 1] : nullptr;
    const DenoisedFrame* const after = f + 1 < frames.size() ? &frames[f + 1] : nullptr;
    auto blended = BlendFrames(before, frames[f], after, 2, {});
    EXPECT_TRUE(blended) << blended.error().message;
    result.blended.push_back(std::move(*blended));
    result.alone.push_back(WithColors(frames[f].picture, frames[f].layers, frames[f].colors));
  }
  return result;
}

// The mean squared change of the light along the motion of the plane from the frames' own.
double Flicker(std::vector<LoadedPicture> frames) {
  double sum = 0;
  int count = 0;
  const auto light = [&](size_t f, int x, int y) {
    return Value(frames[f], "R", x, y) / Panning(static_cast<int>(f), x, y).albedo;
  };
  for (size_t f = 0; f + 2 < frames.size(); f += 2) {
    for (int y = 0; y + 2 < kHigh; ++y) {
      for (int x = 0; x + 5 < kWide; ++x, ++count)
        sum += std::pow(light(f + 2, x + 5, y + 2) - light(f, x, y), 2);  // whole pixels in two frames
    }
  }
  return sum / count;
}

TEST(Temporal, APanningPatternLosesNoiseAndFlicker) {
  const Sequence sequence = DenoiseAll(5, Panning, Pan);
  for (int f = 1; f < 4; ++f) {
    const double alone = ErrorOf(sequence.alone[static_cast<size_t>(f)], At(Panning, f));
    EXPECT_LT(ErrorOf(sequence.blended[static_cast<size_t>(f)], At(Panning, f)), 0.85 * alone) << f;
  }
  EXPECT_LT(ErrorOf(sequence.blended[0], At(Panning, 0)), 0.9 * ErrorOf(sequence.alone[0], At(Panning, 0)))
      << "with one neighbour";
  EXPECT_LT(Flicker(sequence.blended), 0.7 * Flicker(sequence.alone));
}

// A shadow's edge that moves over a plane that stands still.
Point MovingShadow(int frame, int x, int) {
  return {x < 20 + 8 * frame ? 4.0f : 0.5f, 0.5f, 0, 4};
}

TEST(Temporal, AMovingShadowIsNotDraggedAlong) {
  const Sequence sequence = DenoiseAll(3, MovingShadow, Still);
  EXPECT_LT(ErrorOf(sequence.blended[1], At(MovingShadow, 1)),
            ErrorOf(sequence.alone[1], At(MovingShadow, 1)));
}

// A near, bright disc that moves over a far, dark plane, which it uncovers.
bool IsDisc(int frame, int x, int y) {
  return std::hypot(x - 20 - 9 * frame, y - 30) < 14;
}
Point MovingDisc(int frame, int x, int y) {
  return IsDisc(frame, x, y) ? Point{6, 0.5f, 0.7f, 2} : Point{0.5f, 0.5f, 0, 9};
}
std::array<float, 2> OfDisc(int frame, int x, int y) {
  return {IsDisc(frame, x, y) ? 9.0f : 0.0f, 0};
}

TEST(Temporal, WhatAnObjectUncoversIsNotMixedWithIt) {
  const Sequence sequence = DenoiseAll(3, MovingDisc, OfDisc);
  EXPECT_LT(ErrorOf(sequence.blended[1], At(MovingDisc, 1)), ErrorOf(sequence.alone[1], At(MovingDisc, 1)));
  LoadedPicture blended = sequence.blended[1];
  for (int x = 0; x < kWide; ++x) EXPECT_EQ(Value(blended, "R", x, 30) > 1.5f, IsDisc(1, x, 30)) << x;
}

TEST(Temporal, GivesTheSameBitsForAnyNumberOfThreads) {
  const DenoisedFrame a = Alone(FrameOf(0, Panning, Pan)), b = Alone(FrameOf(1, Panning, Pan)),
                      c = Alone(FrameOf(2, Panning, Pan));
  const auto one = BlendFrames(&a, b, &c, 1, {});
  for (const int threads : {2, 5}) EXPECT_EQ(BlendFrames(&a, b, &c, threads, {})->values, one->values);
}

TEST(Temporal, AFrameWithoutUsableNeighboursIsDenoisedAlone) {
  const LoadedPicture picture = FrameOf(1, Panning, Pan);
  const DenoisedFrame frame = Alone(picture), other = Alone(Rendered(9, 9, 0.1f, At(Panning, 0)));
  const LoadedPicture alone = *Denoise(picture, "f.exr", 1, {});
  EXPECT_EQ(BlendFrames(nullptr, frame, nullptr, 2, {})->values, alone.values);
  EXPECT_EQ(BlendFrames(&other, frame, &other, 2, {})->values, alone.values) << "their size is another";
  const DenoisedFrame without_motion = Alone(Rendered(kWide, kHigh, 0.6f, At(Panning, 0)));
  EXPECT_EQ(BlendFrames(&without_motion, frame, nullptr, 2, {})->values, alone.values);
}

TEST(Temporal, VectorsAndDepthsOfAnyValueDoNoHarm) {
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(),
                       std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity(),
                       3e38f,
                       -3e38f,
                       1e-40f,
                       -0.5f};
  std::vector<DenoisedFrame> frames;
  for (int f = 0; f < 3; ++f) {
    LoadedPicture picture = FrameOf(f, Panning, Pan);
    int k = f;
    for (int y = 0; y < kHigh; ++y) {
      for (int x = 0; x < kWide; x += 3, ++k) {
        const char* const channels[] = {"motion.X", "motion.Y", "depth.Z", "normal.X", "R", "halves.G"};
        Value(picture, channels[k % 6], x, y) = bad[k / 6 % 7];
      }
    }
    frames.push_back(Alone(picture));
  }
  LoadedPicture blended = *BlendFrames(&frames[0], frames[1], &frames[2], 2, {});
  for (int y = 0; y < kHigh; ++y) {
    for (int x = 0; x < kWide; ++x) ASSERT_TRUE(std::isfinite(Value(blended, "R", x, y))) << x << " " << y;
  }
}

TEST(Temporal, StopsWhenAskedTo) {
  const DenoisedFrame frame = Alone(FrameOf(1, Panning, Pan));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(BlendFrames(&frame, frame, &frame, 2, stop.get_token()).error().kind, ErrorKind::kInterrupted);
}

}  // namespace
}  // namespace tessera
