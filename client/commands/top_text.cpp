#include "client/commands/top_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "client/progress_line.h"

namespace tessera {
namespace {

constexpr int kEverything = std::numeric_limits<int>::max();
// The widths of terminals from which a line has a long or a short bar.
constexpr int kLongBarColumns = 100, kShortBarColumns = 72;

// Running jobs first, then those that wait, then those that have ended, each from the newest.
int RankOf(const JobStatus& job) {
  if (HasEnded(job.state)) return 2;
  return job.state == JobState::kRunning ? 0 : 1;
}

int RankOf(const WorkerStatus& worker) {
  return worker.quarantined ? 0 : worker.draining ? 1 : worker.leases > 0 ? 2 : 3;
}

// A bar, or nothing on a narrow terminal.
std::string Bar(double share, int columns) {
  if (columns < kShortBarColumns) return {};
  const size_t length = columns >= kLongBarColumns ? 20 : 10;
  const auto full = static_cast<size_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(length));
  return "[" + std::string(full, '#') + std::string(length - full, '.') + "] ";
}

// Adds the parts, as far as there is room beside the reason, and the reason.
std::string WithParts(std::string line, const std::vector<std::string>& parts, const std::string& reason,
                      int columns) {
  const std::string end = reason.empty() ? "" : "  (" + reason + ")";
  const auto has_room = [&](size_t more) {
    return line.size() + more + end.size() <= static_cast<size_t>(columns);
  };
  for (const std::string& part : parts) {
    if (!has_room(2 + part.size())) break;
    if (!part.empty()) line += "  " + part;
  }
  if (!has_room(0)) line.resize(line.find_last_not_of(' ') + 1);
  return line + end;
}

std::string Counted(uint64_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string JobLine(const JobStatus& job, int columns) {
  const double share = job.samples_total == 0
                           ? 0
                           : static_cast<double>(job.samples_done) / static_cast<double>(job.samples_total);
  const std::string left = HasEnded(job.state) ? ""
                           : job.left.count() >= 0
                               ? DurationText(static_cast<double>(job.left.count()) / 1000)
                               : "?";
  const char* const state = JobStateName(job.state);
  if (columns < kShortBarColumns) {
    return WithParts(fmt::format("{:>3} {:<9} {:>3.0f} % {}", Number(job.job), state, 100 * share, job.name),
                     {left}, job.reason, columns);
  }
  const bool is_wide = columns >= kLongBarColumns;
  const std::string workers = Counted(job.workers, "worker");
  return WithParts(fmt::format("{:>5}  {:<9}  {}{:>5.1f} %  {:>11}  {:<{}}", Number(job.job), state,
                               Bar(share, columns), 100 * share, left, job.name, is_wide ? 20 : 16),
                   {is_wide ? fmt::format("{:<11}", workers) : workers, job.owner.name}, job.reason, columns);
}

std::string WorkerLine(const WorkerStatus& worker, int columns) {
  const char* const state = worker.quarantined  ? "quarantined"
                            : worker.draining   ? "draining"
                            : worker.leases > 0 ? "rendering"
                                                : "idle";
  const double percent = 100 * worker.utilisation;
  if (columns < kShortBarColumns) {
    return WithParts(fmt::format("{:<11} {:>3.0f} % {}", state, percent, worker.name), {}, worker.reason,
                     columns);
  }
  return WithParts(fmt::format("{:<11}  {}{:>3.0f} %  {:<20}", state, Bar(worker.utilisation, columns),
                               percent, worker.name),
                   {fmt::format("{:>12.0f} samples/s", worker.samples_per_second),
                    Counted(static_cast<uint64_t>(worker.slots), "thread")},
                   worker.reason, columns);
}

// In as many lines as it takes.
std::vector<std::string> TotalsLines(const FarmView& view, int columns) {
  const auto running = std::ranges::count_if(view.jobs, [](const auto& job) { return RankOf(job) == 0; });
  const auto waiting = std::ranges::count_if(view.jobs, [](const auto& job) { return RankOf(job) == 1; });
  double speed = 0;
  uint64_t threads = 0;
  for (const WorkerStatus& each : view.workers) {
    speed += each.samples_per_second;
    threads += static_cast<uint64_t>(each.slots);
  }
  std::vector<std::string> lines{view.address};
  for (const std::string& part :
       {fmt::format("{} running, {} waiting", running, waiting),
        fmt::format("{} with {}", Counted(view.workers.size(), "worker"), Counted(threads, "thread")),
        fmt::format("{:.0f} samples/s", speed)}) {
    if (lines.back().size() + 3 + part.size() <= static_cast<size_t>(columns)) {
      lines.back() += "   " + part;
    } else {
      lines.push_back(part);
    }
  }
  return lines;
}

// A heading and up to `rows` - 1 lines.
template <typename Status, typename Line>
void AddSection(const std::string& heading, std::vector<Status> list, int rows, Line line,
                std::vector<std::string>& lines) {
  std::ranges::stable_sort(list, {}, [](const Status& each) { return RankOf(each); });
  lines.push_back(heading);
  const auto room = static_cast<size_t>(std::max(rows - 1, 1));
  const size_t shown = list.size() <= room ? list.size() : room - 1;
  for (size_t i = 0; i < shown; ++i) lines.push_back(line(list[i]));
  if (shown < list.size()) lines.push_back(fmt::format("... and {} more", list.size() - shown));
}

// Adds both lists to the lines.
void AddLists(const FarmView& view, int columns, int job_rows, int worker_rows,
              std::vector<std::string>& lines) {
  lines.emplace_back();
  std::vector<JobStatus> newest(view.jobs.rbegin(), view.jobs.rend());
  AddSection(
      "JOBS", std::move(newest), job_rows, [&](const auto& job) { return JobLine(job, columns); }, lines);
  lines.emplace_back();
  AddSection(
      "WORKERS", view.workers, worker_rows, [&](const auto& worker) { return WorkerLine(worker, columns); },
      lines);
}

}  // namespace

std::vector<std::string> TopScreen(const FarmView& view, const TerminalSize& size) {
  std::vector<std::string> lines = TotalsLines(view, size.columns);
  // Below the totals and two empty lines. A list that needs less than half leaves the rest to the other one.
  const int room = std::max(size.rows - static_cast<int>(lines.size()) - 2, 4);
  const int jobs = static_cast<int>(std::min<size_t>(view.jobs.size(), 10'000)) + 1;
  const int workers = static_cast<int>(std::min<size_t>(view.workers.size(), 10'000)) + 1;
  const int job_rows = std::min(jobs, std::max(room / 2, room - workers));
  AddLists(view, size.columns, job_rows, room - job_rows, lines);
  if (lines.size() > static_cast<size_t>(size.rows)) lines.resize(static_cast<size_t>(size.rows));
  for (std::string& each : lines) each = FirstColumns(each, size.columns);
  return lines;
}

std::vector<std::string> TopLines(const FarmView& view) {
  std::vector<std::string> lines = TotalsLines(view, kEverything);
  AddLists(view, kEverything, kEverything, kEverything, lines);
  return lines;
}

}  // namespace tessera
