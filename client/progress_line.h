// Shows the progress of a render on stderr.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace tessera {

struct FrameCount {
  uint32_t finished = 0, total = 1;
};

struct Progress {
  uint64_t samples_done = 0, samples_total = 0;  // pixel samples
  double samples_per_second = 0;
  int workers = 0;
  double elapsed_s = 0;
  double left_s = -1;      // negative: unknown
  std::string remark;      // such as why a job does not progress, or empty
  FrameCount frames;       // shown if there are several
  bool has_ended = false;  // complete or not
};

// "  43.1 %  12.3/28.6 Msamples  1.42 Msamples/s  2 workers  8.7 s elapsed  11 s left". `worker_noun` is what
// renders, in the singular: "worker" or "thread". What matters least is left out if the text has more than
// `columns` bytes: samples first, and the percentage, frames, time left and remark never.
std::string ProgressText(const Progress& progress, const char* worker_noun,
                         size_t columns = std::string::npos);
// "4.2 s", "3 min 12 s", "2 h 5 min"
std::string DurationText(double seconds);

// "12.3 MB"
std::string BytesText(uint64_t bytes);

// On a terminal, one line that is rewritten in place; in a log, a new line every few seconds. Not thread
// safe.
class ProgressLine {
 public:
  // `worker_noun` as in ProgressText.
  explicit ProgressLine(const char* worker_noun);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  // Shows the progress, unless it was shown a moment ago.
  void Show(const Progress& progress);
  // Always shows the progress, and ends the line.
  void Finish(const Progress& progress);

 private:
  void Print(const Progress& progress);

  const char* worker_noun_;
  bool terminal_;
  bool open_ = false;  // the cursor of the terminal is in the line
  std::chrono::steady_clock::time_point next_;
};

}  // namespace tessera
