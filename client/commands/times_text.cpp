#include "client/commands/times_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "client/progress_line.h"

namespace tessera {
namespace {

constexpr double kShareShownMin = 0.01;

struct Part {
  const char* name;
  double seconds;
};

// Returns the parts with the largest first.
std::vector<Part> PartsOf(const JobTimes& times) {
  std::vector<Part> parts{{"rendering", times.render_s},
                          {"rendering discarded results", times.waste_s},
                          {"rendering other jobs", times.other_s},
                          {"waiting for scene files", times.fetch_s},
                          {"building the scene", times.load_s},
                          {"idle", times.idle_s},
                          {"waiting for the last units", times.tail_s},
                          {"waiting for pictures to be written", times.writing_s},
                          {"messages and other overhead", times.overhead_s}};
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Part& a, const Part& b) { return a.seconds > b.seconds; });
  return parts;
}

}  // namespace

std::string TimesTable(const JobTimes& times) {
  const double all = times.SlotSeconds();
  if (all <= 0) return {};
  std::string table = fmt::format("time of the farm, {} of render slots:\n", DurationText(all));
  for (const Part& part : PartsOf(times)) {
    if (part.seconds <= 0) continue;
    table += fmt::format("  {:5.1f} %  {:>12}  {}\n", 100 * part.seconds / all, DurationText(part.seconds),
                         part.name);
  }
  table +=
      fmt::format("coordinator, at the same time: merging {:.2f} s, journal {:.2f} s, pictures {:.2f} s\n",
                  times.merge_s, times.journal_s, times.picture_s);
  return table;
}

std::string TimesLine(const JobTimes& times) {
  const double all = times.SlotSeconds();
  if (all <= 0) return {};
  std::string line;
  for (const Part& part : PartsOf(times)) {
    if (part.seconds < kShareShownMin * all) continue;
    line += fmt::format("{}{:.0f} % {}", line.empty() ? "" : ", ", 100 * part.seconds / all, part.name);
  }
  return line;
}

}  // namespace tessera
