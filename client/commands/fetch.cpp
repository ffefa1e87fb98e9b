// tessera fetch
#include <fmt/format.h>

#include <chrono>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/commands/default_job.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "client/frame_fetcher.h"

namespace tessera {
namespace {

struct FetchOptions {
  std::optional<JobId> job;  // nullopt: the default job
  ConnectionOptions connection;
  OutputOptions output;
  std::optional<int> frame;  // of a sequence, only this one
  bool preview = false;
  bool json = false;
};

void AddFetchFlags(CLI::App& app, FetchOptions& options) {
  AddDefaultJobArgument(app, options.job);
  AddConnectionFlags(app, options.connection);
  AddOutputFlags(app, options.output, "job-JOB.exr");
  AddValue(app, "--frame", "N", WithDefault("Fetch only this frame of a sequence", "all frames"),
           options.frame, WholeNumber<int>(0, kFrameNumberMax));
  AddSwitch(app, "--preview", "Also fetch pictures that are not finished, with what is rendered so far",
            options.preview);
  AddJsonFlag(app, options.json);
}

// The chosen frames of the job, by index.
Result<std::vector<size_t>> ChooseFrames(const FetchOptions& options, JobId job,
                                         const std::vector<FrameStatus>& frames) {
  std::vector<size_t> chosen;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (!options.frame || frames[i].number == *options.frame) chosen.push_back(i);
  }
  if (!chosen.empty()) return chosen;
  return BadInput(fmt::format("job {} has no frame {}; its frames are {} to {}", Number(job), *options.frame,
                              frames.front().number, frames.back().number));
}

PictureNames NamesFor(const FetchOptions& options, JobId job, const std::vector<FrameStatus>& frames) {
  using Numbers = PictureNames::Numbers;
  const std::string picture =
      options.output.picture.empty() ? fmt::format("job-{}.exr", Number(job)) : options.output.picture;
  const bool is_sequence = frames.size() > 1;
  // A scene without --frames is frame 0. Its name is no pattern.
  const Existing existing = options.output.no_clobber ? Existing::kKeep : Existing::kReplace;
  if (!is_sequence && frames.front().number == 0)
    return {picture, options.output.png, Numbers::kNone, existing};
  // A frame that was chosen and named by the user keeps that name.
  const bool is_named = options.frame && !options.output.picture.empty();
  return {picture, options.output.png, is_sequence && !is_named ? Numbers::kAlways : Numbers::kInPlace,
          existing};
}

Result<void> CheckFetch(const FetchOptions& options) {
  if (options.json && TakesStandardOutput(options.output))
    return BadInput("the standard output cannot take both a picture and the answer of --json");
  return {};
}

// "frame 3 of job 1" or "frame 3 and 2 more of job 1".
std::string FramesText(const std::vector<int>& frames, JobId job) {
  const std::string more = frames.size() == 1 ? "" : fmt::format(" and {} more", frames.size() - 1);
  return fmt::format("frame {}{} of job {}", frames.front(), more, Number(job));
}

Error NotFinished(const JobStatus& status, const std::vector<int>& missing, bool have_failed) {
  const char* const verb = missing.size() == 1 ? "is" : "are";
  const std::string name = FramesText(missing, status.job);
  if (have_failed) {
    return Failed(
        fmt::format("{} failed; \"tessera logs {}\" prints why, and --preview fetches what was rendered",
                    name, Number(status.job)));
  }
  if (!HasEnded(status.state)) {
    return Failed(
        fmt::format("{} {} not finished; use --preview to fetch what is rendered so far", name, verb));
  }
  const std::string end = status.state == JobState::kFailed ? "failed" : "was cancelled";
  // Of a sequence, the frames that are missing may be those that were never begun.
  const bool has_picture = status.frames_total == 1 && status.samples_done > 0;
  return Failed(fmt::format("{} {} not finished: the job {}{}", name, verb, end,
                            has_picture ? "; use --preview to fetch what was rendered" : ""));
}

struct Fetched {
  std::vector<int> missing;  // not finished and not asked for
  bool have_failed = true;   // all of these
  std::vector<int> empty;    // of a job that ended before anything was rendered of them
};

Result<Fetched> FetchFrames(const FetchOptions& options, const std::vector<FrameStatus>& frames,
                            const std::vector<size_t>& chosen, FrameFetcher& fetcher) {
  Fetched fetched;
  const bool prints_names = !options.json && !TakesStandardOutput(options.output);
  for (const size_t i : chosen) {
    const FrameStatus& frame = frames[i];
    if (frame.file) {
      if (auto saved = fetcher.Save(i, frame); !saved) return saved.error();
    } else if (!options.preview) {
      fetched.missing.push_back(frame.number);
      fetched.have_failed &= frame.has_failed;
      continue;
    } else {
      const auto saved = fetcher.SavePreview(i, frame.number);
      if (!saved) return saved.error();
      if (!*saved) {
        fetched.empty.push_back(frame.number);
        continue;
      }
    }
    if (prints_names) fmt::print("{}\n", fetcher.saved().back().path);
  }
  return fetched;
}

Result<int> RunFetch(const FetchOptions& options, Cancellation& cancellation) {
  const auto start = std::chrono::steady_clock::now();
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  const auto job = ChooseJob(**client, options.connection, options.job);
  if (!job) return job.error();
  const auto frames = (*client)->Frames(*job);
  if (!frames) return frames.error();
  const auto chosen = ChooseFrames(options, *job, *frames);
  if (!chosen) return chosen.error();
  PictureNames names = NamesFor(options, *job, *frames);
  names.SetExrOutput(options.output.exr);
  std::vector<int> numbers;
  for (const size_t i : *chosen) numbers.push_back((*frames)[i].number);
  if (auto writable = names.Check(numbers); !writable) return writable.error();
  FrameFetcher fetcher(**client, *job, names, cancellation.token());
  const auto fetched = FetchFrames(options, *frames, *chosen, fetcher);
  if (!fetched) return fetched.error();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.json && !fetcher.saved().empty()) {
    fmt::print("{}\n", PicturesJson(fetcher.saved(), frames->size() > 1, seconds));
  }
  if (!fetched->empty.empty())
    return Failed(fmt::format("nothing was rendered of {}", FramesText(fetched->empty, *job)));
  if (fetched->missing.empty()) return 0;
  const auto status = (*client)->Status(*job);
  if (!status) return status.error();
  return NotFinished(*status, fetched->missing, fetched->have_failed);
}

}  // namespace

Command FetchCommand() {
  return MakeCommand<FetchOptions>({
      .name = "fetch",
      .summary = "Fetch the picture of a job, or the pictures of a sequence",
      .examples = {{"Fetch the picture of your job", "tessera fetch -o picture.exr"},
                   {"Fetch the picture of job 12", "tessera fetch 12 -o picture.exr"},
                   {"Fetch what is rendered so far, to look at",
                    "tessera fetch 12 --preview --png preview.png"}},
      .add_flags = AddFetchFlags,
      .check = CheckFetch,
      .run = RunFetch,
  });
}

}  // namespace tessera
