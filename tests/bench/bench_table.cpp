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
    {"load_wall_s", &BenchRow::load_wall_s},
    {"build_wall_s", &BenchRow::build_wall_s},
    {"primitives", &BenchRow::primitives},
    {"bytes_per_primitive", &BenchRow::bytes_per_primitive},
    {"render_cpu_s", &BenchRow::render_cpu_s},
    {"render_wall_s", &BenchRow::render_wall_s},
    {"paths_per_cpu_s", &BenchRow::paths_per_cpu_s},
    {"camera_rays_per_cpu_s", &BenchRow::camera_rays_per_cpu_s},
    {"bounce_rays_per_cpu_s", &BenchRow::bounce_rays_per_cpu_s},
    {"shadow_rays_per_cpu_s", &BenchRow::shadow_rays_per_cpu_s},
    {"instructions_per_path", &BenchRow::instructions_per_path},
    {"traversal_share", &BenchRow::traversal_share},
    {"shapes_share", &BenchRow::shapes_share},
    {"shading_share", &BenchRow::shading_share},
    {"sampling_share", &BenchRow::sampling_share},
    {"textures_share", &BenchRow::textures_share},
    {"lights_share", &BenchRow::lights_share},
    {"other_share", &BenchRow::other_share},
    {"relmse", &BenchRow::relmse},
    {"relmse_x_cpu_s", &BenchRow::relmse_x_cpu_s},
    {"load_spread", &BenchRow::load_spread},
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

// A figure of which less is better, with the relative standard errors of what it depends on.
struct Comparison {
  const char* name;
  double BenchRow::*value;
  double BenchRow::*spread = nullptr;
  double BenchRow::*other_spread = nullptr;

  double SpreadOf(const BenchRow& row) const {
    return std::hypot(spread != nullptr ? row.*spread : 0, other_spread != nullptr ? row.*other_spread : 0);
  }
  Ratio Of(const BenchRow& before, const BenchRow& after) const {
    return RatioOf(before.*value, after.*value, SpreadOf(before), SpreadOf(after));
  }
};
constexpr Comparison kComparisons[] = {
    {"load", &BenchRow::load_cpu_s, &BenchRow::load_spread},
    {"CPU", &BenchRow::render_cpu_s, &BenchRow::cpu_spread},
    {"instructions", &BenchRow::instructions_per_path},
    {"relMSE", &BenchRow::relmse, &BenchRow::relmse_spread},
    {"relMSE x CPU", &BenchRow::relmse_x_cpu_s, &BenchRow::cpu_spread, &BenchRow::relmse_spread},
    {"memory", &BenchRow::peak_mb},
};

// The figure of each column after the first.
Result<std::vector<double BenchRow::*>> ReadHeader(const std::string& line) {
  const std::vector<std::string> names = Split(line, ',');
  std::vector<double BenchRow::*> columns;
  for (size_t i = 1; i < names.size(); ++i) {
    const auto column =
        std::ranges::find_if(kColumns, [&](const Column& each) { return names[i] == each.name; });
    if (column == std::end(kColumns))
      return BadInput(fmt::format("line 1: scene_bench writes no column \"{}\"", names[i]));
    columns.push_back(column->value);
  }
  if (names[0] != "scene" || columns.empty())
    return BadInput("line 1: not the columns that scene_bench writes");
  return columns;
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
  const auto columns = ReadHeader(lines[0]);
  if (!columns) return columns.error();
  for (size_t i = 1; i < lines.size(); ++i) {
    if (lines[i].empty()) continue;
    const std::vector<std::string> fields = Split(lines[i], ',');
    if (fields.size() != columns->size() + 1)
      return BadInput(
          fmt::format("line {}: {} fields instead of {}", i + 1, fields.size(), columns->size() + 1));
    BenchRow row;
    row.scene = fields[0];
    for (size_t c = 0; c < columns->size(); ++c) {
      char* end = nullptr;
      row.*(*columns)[c] = std::strtod(fields[c + 1].c_str(), &end);
      if (end == fields[c + 1].c_str() || *end != 0)
        return BadInput(fmt::format("line {}: \"{}\" is not a number", i + 1, fields[c + 1]));
    }
    rows.push_back(row);
  }
  return rows;
}

std::string CompareBenches(const std::vector<BenchRow>& before, const std::vector<BenchRow>& after) {
  std::string table = "| scene |", rule = "|---|";
  for (const Comparison& each : kComparisons) {
    table += fmt::format(" {} |", each.name);
    rule += "---|";
  }
  table += "\n" + rule + "\n";
  std::array<double, std::size(kComparisons)> sums{};
  std::array<int, std::size(kComparisons)> counts{};
  for (const BenchRow& b : before) {
    const auto a = std::ranges::find(after, b.scene, &BenchRow::scene);
    if (a == after.end()) continue;
    table += fmt::format("| {} |", b.scene);
    for (size_t i = 0; i < std::size(kComparisons); ++i) {
      const Ratio ratio = kComparisons[i].Of(b, *a);
      table += fmt::format(" {} |", ratio.Text());
      sums[i] += ratio.log;
      counts[i] += ratio.is_known ? 1 : 0;
    }
    table += "\n";
  }
  table += "| geometric mean |";
  for (size_t i = 0; i < sums.size(); ++i)
    table += counts[i] == 0 ? " - |" : fmt::format(" {:.3f} |", std::exp(sums[i] / counts[i]));
  return table + "\n";
}

}  // namespace tessera
