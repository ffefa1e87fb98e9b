// What scene_bench measures, as CSV, and the comparison of two such files.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// The figures of one scene: means over the seeds.
struct BenchRow {
  std::string scene;
  double load_cpu_s = 0;
  double render_cpu_s = 0, render_wall_s = 0;
  double paths_per_cpu_s = 0;
  double camera_rays_per_cpu_s = 0, bounce_rays_per_cpu_s = 0, shadow_rays_per_cpu_s = 0;
  double relmse = 0;  // 0 without a reference
  double relmse_x_cpu_s = 0;
  // Relative standard errors of the means; 0 if there is one seed.
  double cpu_spread = 0, relmse_spread = 0;
  double peak_mb = 0;  // of the process up to here, so of the largest scene so far
};

std::string ToCsv(const std::vector<BenchRow>& rows);
// Returns an error that names the line for anything that ToCsv does not write.
Result<std::vector<BenchRow>> ReadBenchCsv(std::string_view text);

// A table of the scenes that both have: CPU seconds, relMSE and their product of `before` divided by those of
// `after`, so that more than 1 is better. A ratio within twice its standard error of 1 has a "~". The last
// line has the geometric means.
std::string CompareBenches(const std::vector<BenchRow>& before, const std::vector<BenchRow>& after);

}  // namespace tessera
