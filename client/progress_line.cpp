#include "client/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

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

std::string ProgressText(const Progress& progress, const char* worker_noun) {
  const double done = static_cast<double>(progress.samples_done);
  const double total = static_cast<double>(progress.samples_total);
  const double percent = total > 0 ? 100 * done / total : 0;
  std::string text = fmt::format("{:5.1f} %  {}samples of {}samples  {}samples/s  {} {}{}  {} elapsed",
                                 percent, WithPrefix(done), WithPrefix(total),
                                 WithPrefix(progress.samples_per_second), progress.workers, worker_noun,
                                 progress.workers == 1 ? "" : "s", DurationText(progress.elapsed_s));
  if (progress.frames.total > 1) {
    text += fmt::format("  {} of {} frames", progress.frames.finished, progress.frames.total);
  }
  if (progress.samples_done < progress.samples_total && !progress.has_ended) {
    text += progress.left_s >= 0 ? fmt::format("  {} left", DurationText(progress.left_s))
                                 : "  time left unknown";
  }
  if (!progress.remark.empty()) text += fmt::format("  ({})", progress.remark);
  return text;
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
  const std::string text = ProgressText(progress, worker_noun_);
  if (terminal_) {
    // Fits into one line of the terminal, and clears the rest of a longer one.
    PrintNote("\r{}\x1b[K", FirstColumns(text, TerminalSizeOf(STDERR_FILENO).columns - 1));
  } else {
    PrintNote("{}\n", text);
  }
  open_ = terminal_;
}

}  // namespace tessera
