#include "client/commands/top_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "client/progress_line.h"

namespace tessera {
namespace {

constexpr int kEverything = std::numeric_limits<int>::max();
constexpr int kBarColumns = 20;
constexpr int kHeadRows = 2;  // totals and an empty line

// Running jobs first, then those that wait, then those that have ended, each from the newest.
int RankOf(const JobStatus& job) {
  if (HasEnded(job.state)) return 2;
  return job.state == JobState::kRunning ? 0 : 1;
}

int RankOf(const WorkerStatus& worker) {
  return worker.quarantined ? 0 : worker.draining ? 1 : worker.leases > 0 ? 2 : 3;
}

std::string Bar(double share) {
  const int full = static_cast<int>(std::clamp(share, 0.0, 1.0) * kBarColumns);
  return "[" + std::string(static_cast<size_t>(full), '#') +
         std::string(static_cast<size_t>(kBarColumns - full), '.') + "]";
}

std::string JobLine(const JobStatus& job) {
  const double share = job.samples_total == 0
                           ? 0
                           : static_cast<double>(job.samples_done) / static_cast<double>(job.samples_total);
  const std::string left = HasEnded(job.state) ? ""
                           : job.left.count() >= 0
                               ? DurationText(static_cast<double>(job.left.count()) / 1000)
                               : "?";
  return fmt::format("{:>6}  {:<9}  {} {:>5.1f} %  {:>4} worker{}  {:>12}  {:<12}  {}{}", Number(job.job),
                     JobStateName(job.state), Bar(share), 100 * share, job.workers,
                     job.workers == 1 ? " " : "s", left, job.owner.name, job.name,
                     job.reason.empty() ? "" : "  (" + job.reason + ")");
}

std::string WorkerLine(const WorkerStatus& worker) {
  const char* const state = worker.quarantined  ? "quarantined"
                            : worker.draining   ? "draining"
                            : worker.leases > 0 ? "rendering"
                                                : "idle";
  return fmt::format("{:<11}  {} {:>3.0f} %  {:>12.0f} samples/s  {:>3} threads  {}{}", state,
                     Bar(worker.utilisation), 100 * worker.utilisation, worker.samples_per_second,
                     worker.slots, worker.name, worker.reason.empty() ? "" : "  (" + worker.reason + ")");
}

std::string TotalsLine(const FarmView& view) {
  const auto running = std::ranges::count_if(view.jobs, [](const auto& job) { return RankOf(job) == 0; });
  const auto waiting = std::ranges::count_if(view.jobs, [](const auto& job) { return RankOf(job) == 1; });
  double speed = 0;
  uint64_t threads = 0;
  for (const WorkerStatus& each : view.workers) {
    speed += each.samples_per_second;
    threads += static_cast<uint64_t>(each.slots);
  }
  const auto counted = [](uint64_t count, const char* noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
  };
  return fmt::format("{}   {} running, {} waiting   {} with {}   {:.0f} samples/s", view.address, running,
                     waiting, counted(view.workers.size(), "worker"), counted(threads, "thread"), speed);
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

std::vector<std::string> Lines(const FarmView& view, int job_rows, int worker_rows) {
  std::vector<std::string> lines{TotalsLine(view), ""};
  std::vector<JobStatus> newest(view.jobs.rbegin(), view.jobs.rend());
  AddSection("JOBS", std::move(newest), job_rows, JobLine, lines);
  lines.emplace_back();
  AddSection("WORKERS", view.workers, worker_rows, WorkerLine, lines);
  return lines;
}

}  // namespace

std::vector<std::string> TopScreen(const FarmView& view, const TerminalSize& size) {
  // A list that needs less than half leaves the rest to the other one.
  const int room = std::max(size.rows - kHeadRows - 1, 4);
  const int jobs = static_cast<int>(std::min<size_t>(view.jobs.size(), 10'000)) + 1;
  const int workers = static_cast<int>(std::min<size_t>(view.workers.size(), 10'000)) + 1;
  const int job_rows = std::min(jobs, std::max(room / 2, room - workers));
  std::vector<std::string> lines = Lines(view, job_rows, room - job_rows);
  if (lines.size() > static_cast<size_t>(size.rows)) lines.resize(static_cast<size_t>(size.rows));
  for (std::string& each : lines) each = FirstColumns(each, size.columns);
  return lines;
}

std::vector<std::string> TopLines(const FarmView& view) {
  return Lines(view, kEverything, kEverything);
}

}  // namespace tessera
