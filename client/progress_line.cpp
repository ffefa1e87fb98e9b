#include "client/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "client/terminal.h"
#include "proto/shell/console.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kTerminalInterval{100};  // as fast as an eye can follow
constexpr std::chrono::milliseconds kLogInterval{5000};      // a log stays readable

// The number scaled below 1000 if possible, with the prefix of its scale: "12.3 M".
std::string WithPrefix(double value) {
  const char* prefix = "";
  if (value >= 1e9) {
    value /= 1e9;
    prefix = "G";
  } else if (value >= 1e6) {
    value /= 1e6;
    prefix = "M";
  } else if (value >= 1e3) {
    value /= 1e3;
    prefix = "k";
  }
  return fmt::format("{:.{}f} {}", value, *prefix == '\0' || value >= 100 ? 0 : (value >= 10 ? 1 : 2),
                     prefix);
}

}  // namespace

std::string DurationText(double seconds) {
  seconds = std::max(seconds, 0.0);
  if (seconds < 60) return fmt::format("{:.1f} s", seconds);
  const int64_t whole = std::llround(seconds);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string BytesText(uint64_t bytes) {
  return WithPrefix(static_cast<double>(bytes)) + "B";
}

std::string ProgressText(const Progress& progress, const char* worker_noun, size_t columns) {
  const double done = static_cast<double>(progress.samples_done);
  const double total = static_cast<double>(progress.samples_total);
  const double percent = total > 0 ? 100 * done / total : 0;
  // In the order in which they are shown. Those with the highest number are left out first; 0: never.
  struct Part {
    int dispensable;
    std::string text;
  };
  std::vector<Part> parts{
      {0, fmt::format("{:5.1f} %", percent)},
      {4, fmt::format("{}samples of {}samples", WithPrefix(done), WithPrefix(total))},
      {2, fmt::format("{}samples/s", WithPrefix(progress.samples_per_second))},
      {1, fmt::format("{} {}{}", progress.workers, worker_noun, progress.workers == 1 ? "" : "s")},
      {3, fmt::format("{} elapsed", DurationText(progress.elapsed_s))}};
  if (progress.frames.total > 1)
    parts.push_back({0, fmt::format("{} of {} frames", progress.frames.finished, progress.frames.total)});
  if (progress.samples_done < progress.samples_total && !progress.has_ended) {
    parts.push_back({0, progress.left_s >= 0 ? fmt::format("{} left", DurationText(progress.left_s))
                                             : "time left unknown"});
  }
  if (!progress.remark.empty()) parts.push_back({0, fmt::format("({})", progress.remark)});
  const auto joined = [&] {
    std::string text;
    for (const Part& part : parts) text += (text.empty() ? "" : "  ") + part.text;
    return text;
  };
  while (joined().size() > columns) {
    const auto least = std::ranges::max_element(parts, {}, &Part::dispensable);
    if (least->dispensable == 0) break;
    parts.erase(least);
  }
  return joined();
}

ProgressLine::ProgressLine(const char* worker_noun)
    : worker_noun_(worker_noun),
      terminal_(::isatty(STDERR_FILENO) == 1),
      next_(std::chrono::steady_clock::now()) {}

ProgressLine::~ProgressLine() {
  if (open_) PrintNote("\n");
}

void ProgressLine::Show(const Progress& progress) {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + (terminal_ ? kTerminalInterval : kLogInterval);
  Print(progress);
}

void ProgressLine::Finish(const Progress& progress) {
  Print(progress);
  if (open_) PrintNote("\n");
  open_ = false;
}

void ProgressLine::Print(const Progress& progress) {
  if (terminal_) {
    // Fits into one line of the terminal, and clears the rest of a longer one.
    const int columns = std::max(TerminalSizeOf(STDERR_FILENO).columns - 1, 1);
    const std::string text = ProgressText(progress, worker_noun_, static_cast<size_t>(columns));
    PrintNote("\r{}\x1b[K", FirstColumns(text, columns));
  } else {
    PrintNote("{}\n", ProgressText(progress, worker_noun_));
  }
  open_ = terminal_;
}

}  // namespace tessera
