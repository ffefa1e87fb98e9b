// For benchmarks: renders a whole frame on threads of this process, measures the time, and compares the
// picture with references.
#pragma once

#include <string>

#include "renderer/film/merger.h"
#include "renderer/film/picture_file.h"
#include "renderer/scene/scene.h"

namespace tessera {

// CPU time of this process, all threads.
double CpuSeconds();
// Time since an arbitrary moment.
double WallSeconds();

struct FrameRun {
  FramePicture picture;
  RenderStatistics rays;
  double cpu_seconds = 0, wall_seconds = 0;
};
// Renders every pixel of the frame on `threads` threads.
FrameRun RenderWhole(const Scene& scene, int threads);

// References of one picture: one, or two that are independent of each other.
struct References {
  std::vector<LoadedPicture> pictures;

  // `paths`: one or two EXR files, separated by a comma.
  static Result<References> Load(const std::string& paths);
};

// The mean over R, G and B of (a - b)^2 / (b^2 + 0.01).
struct RelativeError {
  double all = 0;
  double trimmed = 0;    // the largest 0.1 % of values left out: fireflies
  double reference = 0;  // of the references' mean, by their difference; 0 if there is only one
};
// With two references r and s the square is (a - r) (a - s), whose mean does not contain the noise of the
// references. With one it does.
RelativeError RelativeErrorOf(const FramePicture& picture, const References& references);

}  // namespace tessera
