// tessera fetch: the picture of a job, or those of a sequence.
#include <fmt/format.h>

#include <chrono>

#include "client/commands.h"
#include "client/frame_fetcher.h"
#include "client/reach_coordinator.h"

namespace tessera {
namespace {

// Which of the job's frames are asked for, by index.
Result<std::vector<size_t>> Choose(const Options& options, const std::vector<FrameStatus>& frames) {
  std::vector<size_t> chosen;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (!options.frame || frames[i].number == *options.frame) chosen.push_back(i);
  }
  if (!chosen.empty()) return chosen;
  return BadInput(fmt::format("job {} has no frame {}: its frames are {} to {}", options.job, *options.frame,
                              frames.front().number, frames.back().number));
}

Error NotFinished(uint64_t job, const std::vector<int>& missing) {
  const size_t more = missing.size() - 1;
  return Failed(fmt::format("frame {}{} of job {} {} not finished; --preview takes what is there",
                            missing.front(), more == 0 ? "" : fmt::format(" and {} more", more), job,
                            more == 0 ? "is" : "are"));
}

}  // namespace

Result<int> RunFetch(const Options& options, Cancellation& cancellation) {
  const auto start = std::chrono::steady_clock::now();
  const std::string output = options.output.empty() ? fmt::format("job-{}.exr", options.job) : options.output;
  const auto client = ReachCoordinator(options, cancellation);
  if (!client) return client.error();
  const auto frames = (*client)->Frames(JobId{options.job});
  if (!frames) return frames.error();
  const auto chosen = Choose(options, *frames);
  if (!chosen) return chosen.error();
  const bool is_sequence = frames->size() > 1;
  const bool is_named = options.frame && !options.output.empty();
  const PictureNames names(
      output, options.png,
      is_sequence && !is_named ? PictureNames::Numbers::kAlways : PictureNames::Numbers::kInPlace);
  std::vector<int> numbers, missing;
  for (const size_t i : *chosen) numbers.push_back((*frames)[i].number);
  if (auto writable = names.Check(numbers); !writable) return writable.error();
  FrameFetcher fetcher(**client, JobId{options.job}, names);
  for (const size_t i : *chosen) {
    const FrameStatus& frame = (*frames)[i];
    if (!frame.file && !options.preview) {
      missing.push_back(frame.number);
      continue;
    }
    auto saved = frame.file ? fetcher.Save(i, frame) : fetcher.SavePreview(i, frame.number);
    if (!saved) return saved.error();
    if (!options.json) fmt::print("{}\n", fetcher.saved().back().path);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.json && !fetcher.saved().empty()) {
    fmt::print("{}\n", PicturesJson(fetcher.saved(), is_sequence, seconds));
  }
  if (!missing.empty()) return NotFinished(options.job, missing);
  return 0;
}

}  // namespace tessera
