// tessera render: a scene or a sequence of frames, on this box.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "client/commands.h"
#include "client/coordinator/coordinator_client.h"
#include "client/frame_fetcher.h"
#include "client/in_process.h"
#include "client/local_farm.h"
#include "client/output.h"
#include "client/progress_line.h"
#include "client/scene_job.h"
#include "client/status_text.h"
#include "client/times_text.h"
#include "client/watching.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/cores.h"
#include "renderer/util/digest.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

struct Crew {
  int workers;
  int threads;  // of each
};

// Without numbers from the user: one process with a thread for each core, since a scene is then loaded once;
// two if they are to check each other.
Crew ChooseCrew(const Options& options) {
  const int workers = options.workers > 0 ? options.workers : options.verify_share > 0 ? 2 : 1;
  const int threads = options.threads > 0 ? options.threads : std::max(1, UsableCores() / workers);
  return {workers, threads};
}

// One picture on its way to its files.
Result<SavedPicture> Save(const FrameSpec& spec, const FramePicture& picture, int number,
                          const PictureNames& names) {
  const auto exr = EncodeExr(spec, picture);
  if (!exr) return exr.error();
  if (auto written = WritePicture(*exr, names.Exr(number), names.Png(number)); !written)
    return written.error();
  return SavedPicture{number, names.Exr(number), Sha256(*exr)};
}

// Frame after frame, in this process. All have been checked before the first is rendered.
Result<std::vector<SavedPicture>> RenderHere(const Options& options, const PictureNames& names,
                                             Cancellation& cancellation) {
  const std::stop_token stop = cancellation.token();
  auto job = LoadSceneJob(options, options.frames ? Scene::Depth::kCheck : Scene::Depth::kRender, stop);
  if (!job) return job.error();
  const Crew crew = ChooseCrew(options);
  ProgressLine line("thread");
  FrameCount count{0, static_cast<uint32_t>(job->frames.size())};
  std::vector<SavedPicture> saved;
  for (size_t i = 0; i < job->frames.size(); ++i) {
    if (options.frames) {
      job->scene = nullptr;  // the next one takes its memory
      auto loaded = LoadFrame(job->frames[i], Scene::Depth::kRender, job->cache);
      if (!loaded) return loaded.error();
      job->scene = std::move(loaded->scene);
    }
    if (cancellation.cancelled()) return cancellation.error();
    const FrameSpec& spec = job->packed.frames[i].spec;
    Progress last;
    const auto picture =
        RenderInProcess(*job->scene, spec, crew.workers * crew.threads, stop, [&](const Progress& progress) {
          last = progress;
          last.frames = count;
          if (progress.samples_done < progress.samples_total) line.Show(last);
        });
    if (!picture) return picture.error();
    ++last.frames.finished;
    ++count.finished;
    line.Finish(last);
    auto picture_saved = Save(spec, *picture, job->frames[i].number, names);
    if (!picture_saved) return picture_saved.error();
    saved.push_back(std::move(*picture_saved));
  }
  return saved;
}

Result<std::vector<SavedPicture>> RenderOnLocalFarm(const Options& options, const PictureNames& names,
                                                    Cancellation& cancellation) {
  const auto job = LoadSceneJob(options, Scene::Depth::kCheck, cancellation.token());
  if (!job) return job.error();
  const Crew crew = ChooseCrew(options);
  const auto farm = LocalFarm::Start(crew.workers, crew.threads, cancellation);
  if (!farm) return farm.error();
  const auto client = CoordinatorClient::Connect((*farm)->address(), options.patience, cancellation.token());
  if (!client) return client.error();
  if (auto sent = (*client)->Upload(job->packed); !sent) return sent.error();
  const auto id =
      (*client)->Submit(job->packed, {job->packed.frames[0].scene_file, 0, {}, options.verify_share});
  if (!id) return id.error();
  FrameFetcher fetcher(**client, *id, names);
  uint32_t finished = 0;
  const auto status = WatchWithProgress(**client, *id, [&](const JobStatus& now) {
    if (now.frames_finished == finished || cancellation.cancelled()) return;
    finished = now.frames_finished;
    // What is finished is kept, whatever becomes of the rest.
    if (auto saved = fetcher.SaveFinished(); !saved) cancellation.Cancel(saved.error());
  });
  if (!status) return status.error();
  if (status->state != JobState::kFinished) return EndedWithoutPicture(*status);
  if (const std::string line = TimesLine(status->times); !line.empty())
    fmt::print(stderr, "the farm's time: {}\n", line);
  if (auto saved = fetcher.SaveFinished(); !saved) return saved.error();
  return fetcher.saved();
}

std::string DefaultOutput(const Options& options) {
  std::filesystem::path name = std::filesystem::path(options.scene).filename();
  if (name.extension() == ".gz") name.replace_extension();
  return name.replace_extension(".exr").string();
}

}  // namespace

Result<int> RunRender(const Options& options, Cancellation& cancellation) {
  const auto start = Clock::now();
  if (options.verify_share > 0 && (options.in_process || options.workers == 1)) {
    return BadInput("--verify needs at least two workers to compare: --workers 2, or more");
  }
  const bool is_sequence = options.frames.has_value();
  const PictureNames names(options.output.empty() ? DefaultOutput(options) : options.output, options.png,
                           is_sequence ? PictureNames::Numbers::kAlways : PictureNames::Numbers::kNone);
  const std::vector<int> numbers = is_sequence ? options.frames->Numbers() : std::vector<int>{0};
  if (auto writable = names.Check(numbers); !writable) return writable.error();
  const auto saved = options.in_process ? RenderHere(options, names, cancellation)
                                        : RenderOnLocalFarm(options, names, cancellation);
  if (!saved) return saved.error();
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const std::string what = is_sequence ? fmt::format(": {} frames", saved->size()) : "";
  fmt::print(stderr, "{}{} rendered in {}\n", names.output(), is_sequence ? what : ":",
             DurationText(seconds));
  if (options.json) fmt::print("{}\n", PicturesJson(*saved, is_sequence, seconds));
  return 0;
}

}  // namespace tessera
