// What scene_bench measures, as CSV, and the comparison of two such files.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// The figures of one scene: means over the seeds. What was not measured is 0.
struct BenchRow {
  std::string scene;
  double load_cpu_s = 0, load_wall_s = 0;  // with building
  double build_wall_s = 0;                 // of the accelerator
  double primitives = 0;
  double bytes_per_primitive = 0;  // of geometry and accelerator
  double render_cpu_s = 0, render_wall_s = 0;
  double paths_per_cpu_s = 0;
  double camera_rays_per_cpu_s = 0, bounce_rays_per_cpu_s = 0, shadow_rays_per_cpu_s = 0;
  double instructions_per_path = 0;
  // Shares of the time of rendering (time_profile.h).
  double traversal_share = 0, shapes_share = 0, shading_share = 0, sampling_share = 0, textures_share = 0,
         lights_share = 0, other_share = 0;
  double relmse = 0;
  double relmse_x_cpu_s = 0;
  // Relative standard errors of the means; 0 if there is one seed.
  double load_spread = 0, cpu_spread = 0, relmse_spread = 0;
  double peak_mb = 0;  // while the scene was loaded and rendered
};

std::string ToCsv(const std::vector<BenchRow>& rows);
// Returns an error that names the line for anything that ToCsv does not write. Columns may be in any order
// and some may be missing, as in files of earlier programs.
Result<std::vector<BenchRow>> ReadBenchCsv(std::string_view text);

// A table of the scenes that both have: figures of `before` divided by those of `after`, so that more than 1
// is better. A ratio within twice its standard error of 1 has a "~"; instructions and memory have no error.
// The last line has the geometric means.
std::string CompareBenches(const std::vector<BenchRow>& before, const std::vector<BenchRow>& after);

}  // namespace tessera
