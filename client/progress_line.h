// Says on stderr how far a render is.
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
  double left_s = -1;      // negative: not known yet
  std::string remark;      // why nothing moves and the like, or empty
  FrameCount frames;       // told if there are several
  bool has_ended = false;  // nothing more will come, whether all is done or not
};

// "  43.1 %  12.3/28.6 Msamples  1.42 Msamples/s  2 workers  8.7 s elapsed  11 s left"
std::string ProgressText(const Progress& progress, const char* worker_word);
// "4.2 s", "3 min 12 s", "2 h 5 min"
std::string DurationText(double seconds);

// "12.3 MB"
std::string BytesText(uint64_t bytes);

// One line rewritten in place on a terminal; otherwise a line of its own, now and then. Not thread safe.
class ProgressLine {
 public:
  // `worker_word` is what does the work, in singular: "worker" or "thread".
  explicit ProgressLine(const char* worker_word);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  // Shows it, unless the last one was shown a moment ago.
  void Show(const Progress& progress);
  // Shows it in any case and ends the line.
  void Finish(const Progress& progress);

 private:
  void Print(const Progress& progress);

  const char* worker_word_;
  bool terminal_;
  bool open_ = false;  // the terminal's cursor is in our line
  std::chrono::steady_clock::time_point next_;
};

}  // namespace tessera
