// tessera fetch
#include <fmt/format.h>

#include <chrono>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "client/frame_fetcher.h"

namespace tessera {
namespace {

struct FetchOptions {
  JobId job{};
  ConnectionOptions connection;
  OutputOptions output;
  std::optional<int> frame;  // of a sequence, only this one
  bool preview = false;
  bool json = false;
};

void AddFetchFlags(CLI::App& app, FetchOptions& options) {
  AddJobArgument(app, options.job);
  AddConnectionFlags(app, options.connection);
  AddOutputFlags(app, options.output, "job-JOB.exr");
  AddValue(app, "--frame", "N", WithDefault("Fetch only this frame of a sequence", "all frames"),
           options.frame, WholeNumber<int>(0, kFrameNumberMax));
  AddSwitch(app, "--preview", "Also fetch pictures that are not finished, with what is rendered so far",
            options.preview);
  AddJsonFlag(app, options.json);
}

// The chosen frames of the job, by index.
Result<std::vector<size_t>> ChooseFrames(const FetchOptions& options,
                                         const std::vector<FrameStatus>& frames) {
  std::vector<size_t> chosen;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (!options.frame || frames[i].number == *options.frame) chosen.push_back(i);
  }
  if (!chosen.empty()) return chosen;
  return BadInput(fmt::format("job {} has no frame {}; its frames are {} to {}", Number(options.job),
                              *options.frame, frames.front().number, frames.back().number));
}

PictureNames NamesFor(const FetchOptions& options, bool is_sequence) {
  const std::string exr =
      options.output.exr.empty() ? fmt::format("job-{}.exr", Number(options.job)) : options.output.exr;
  // A frame that was chosen and named by the user keeps that name.
  const bool is_named = options.frame && !options.output.exr.empty();
  return {exr, options.output.png,
          is_sequence && !is_named ? PictureNames::Numbers::kAlways : PictureNames::Numbers::kInPlace};
}

Error NotFinished(JobId job, const std::vector<int>& missing) {
  const size_t more = missing.size() - 1;
  return Failed(fmt::format(
      "frame {}{} of job {} {} not finished; use --preview to fetch what is rendered so far", missing.front(),
      more == 0 ? "" : fmt::format(" and {} more", more), Number(job), more == 0 ? "is" : "are"));
}

Result<int> RunFetch(const FetchOptions& options, Cancellation& cancellation) {
  const auto start = std::chrono::steady_clock::now();
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  const auto frames = (*client)->Frames(options.job);
  if (!frames) return frames.error();
  const auto chosen = ChooseFrames(options, *frames);
  if (!chosen) return chosen.error();
  const bool is_sequence = frames->size() > 1;
  const PictureNames names = NamesFor(options, is_sequence);
  std::vector<int> numbers, missing;
  for (const size_t i : *chosen) numbers.push_back((*frames)[i].number);
  if (auto writable = names.CheckWritable(numbers); !writable) return writable.error();
  FrameFetcher fetcher(**client, options.job, names);
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

}  // namespace

Command FetchCommand() {
  return MakeCommand<FetchOptions>({
      .name = "fetch",
      .summary = "Fetch the picture of a job, or the pictures of a sequence",
      .add_flags = AddFetchFlags,
      .run = RunFetch,
  });
}

}  // namespace tessera
