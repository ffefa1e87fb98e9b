#include "tests/bench/bench_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace tessera {
namespace {

struct Column {
  const char* name;
  double BenchRow::*value;
};
constexpr Column kColumns[] = {
    {"load_cpu_s", &BenchRow::load_cpu_s},
    {"render_cpu_s", &BenchRow::render_cpu_s},
    {"render_wall_s", &BenchRow::render_wall_s},
    {"paths_per_cpu_s", &BenchRow::paths_per_cpu_s},
    {"camera_rays_per_cpu_s", &BenchRow::camera_rays_per_cpu_s},
    {"bounce_rays_per_cpu_s", &BenchRow::bounce_rays_per_cpu_s},
    {"shadow_rays_per_cpu_s", &BenchRow::shadow_rays_per_cpu_s},
    {"relmse", &BenchRow::relmse},
    {"relmse_x_cpu_s", &BenchRow::relmse_x_cpu_s},
    {"cpu_spread", &BenchRow::cpu_spread},
    {"relmse_spread", &BenchRow::relmse_spread},
    {"peak_mb", &BenchRow::peak_mb},
};

std::string Header() {
  std::string header = "scene";
  for (const Column& column : kColumns) header += fmt::format(",{}", column.name);
  return header;
}

std::vector<std::string> Split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (size_t start = 0; start <= text.size();) {
    const size_t end = std::min(text.find(separator, start), text.size());
    parts.emplace_back(text.substr(start, end - start));
    start = end + 1;
  }
  return parts;
}

// before / after, or nullopt if one of them was not measured.
struct Ratio {
  double log = 0;
  double error = 0;  // standard error of the logarithm
  bool is_known = false;

  std::string Text() const {
    if (!is_known) return "-";
    const bool is_noise = error > 0 && std::abs(log) <= 2 * error;
    return fmt::format("{:.3f}{}", std::exp(log), is_noise ? "~" : "");
  }
};

Ratio RatioOf(double before, double after, double spread_before, double spread_after) {
  if (!(before > 0) || !(after > 0)) return {};
  return {std::log(before / after), std::hypot(spread_before, spread_after), true};
}

}  // namespace

std::string ToCsv(const std::vector<BenchRow>& rows) {
  std::string csv = Header() + "\n";
  for (const BenchRow& row : rows) {
    csv += row.scene;
    for (const Column& column : kColumns) csv += fmt::format(",{:.6g}", row.*column.value);
    csv += "\n";
  }
  return csv;
}

Result<std::vector<BenchRow>> ReadBenchCsv(std::string_view text) {
  std::vector<BenchRow> rows;
  const std::vector<std::string> lines = Split(text, '\n');
  if (lines[0] != Header()) return BadInput("line 1: not the columns that scene_bench writes");
  for (size_t i = 1; i < lines.size(); ++i) {
    if (lines[i].empty()) continue;
    const std::vector<std::string> fields = Split(lines[i], ',');
    if (fields.size() != std::size(kColumns) + 1)
      return BadInput(
          fmt::format("line {}: {} fields instead of {}", i + 1, fields.size(), std::size(kColumns) + 1));
    BenchRow row;
    row.scene = fields[0];
    for (size_t c = 0; c < std::size(kColumns); ++c) {
      char* end = nullptr;
      row.*kColumns[c].value = std::strtod(fields[c + 1].c_str(), &end);
      if (end == fields[c + 1].c_str() || *end != 0)
        return BadInput(fmt::format("line {}: \"{}\" is not a number", i + 1, fields[c + 1]));
    }
    rows.push_back(row);
  }
  return rows;
}

std::string CompareBenches(const std::vector<BenchRow>& before, const std::vector<BenchRow>& after) {
  std::string table = "| scene | CPU | relMSE | relMSE x CPU |\n|---|---|---|---|\n";
  std::array<double, 3> sums{};
  std::array<int, 3> counts{};
  for (const BenchRow& b : before) {
    const auto a = std::ranges::find(after, b.scene, &BenchRow::scene);
    if (a == after.end()) continue;
    const std::array<Ratio, 3> ratios{
        RatioOf(b.render_cpu_s, a->render_cpu_s, b.cpu_spread, a->cpu_spread),
        RatioOf(b.relmse, a->relmse, b.relmse_spread, a->relmse_spread),
        RatioOf(b.relmse_x_cpu_s, a->relmse_x_cpu_s, std::hypot(b.cpu_spread, b.relmse_spread),
                std::hypot(a->cpu_spread, a->relmse_spread))};
    table +=
        fmt::format("| {} | {} | {} | {} |\n", b.scene, ratios[0].Text(), ratios[1].Text(), ratios[2].Text());
    for (size_t i = 0; i < ratios.size(); ++i) {
      sums[i] += ratios[i].log;
      counts[i] += ratios[i].is_known ? 1 : 0;
    }
  }
  table += "| geometric mean |";
  for (size_t i = 0; i < sums.size(); ++i)
    table += counts[i] == 0 ? " - |" : fmt::format(" {:.3f} |", std::exp(sums[i] / counts[i]));
  return table + "\n";
}

}  // namespace tessera
