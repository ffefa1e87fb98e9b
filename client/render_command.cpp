// tessera render: one scene, one picture, on this box.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "client/commands.h"
#include "client/in_process.h"
#include "client/local_farm.h"
#include "client/output.h"
#include "client/progress_line.h"
#include "client/scene_job.h"
#include "client/status_text.h"
#include "client/watching.h"
#include "farm/coordinator_client.h"
#include "film/picture_file.h"
#include "util/cores.h"
#include "util/digest.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

struct Crew {
  int workers;
  int threads;  // of each
};

// Without numbers from the user: one process with a thread for each core, since a scene is then loaded once.
Crew ChooseCrew(const Options& options) {
  const int workers = options.workers > 0 ? options.workers : 1;
  const int threads = options.threads > 0 ? options.threads : std::max(1, UsableCores() / workers);
  return {workers, threads};
}

Result<std::string> RenderHere(const Options& options, Cancellation& cancellation) {
  const auto job = LoadSceneJob(options, Scene::Depth::kRender);
  if (!job) return job.error();
  if (cancellation.cancelled()) return cancellation.error();
  const Crew crew = ChooseCrew(options);
  ProgressLine line("thread");
  Progress last;
  const auto picture =
      RenderInProcess(*job, crew.workers * crew.threads, cancellation.token(), [&](const Progress& progress) {
        last = progress;
        if (progress.samples_done < progress.samples_total) line.Show(progress);
      });
  if (!picture) return picture.error();
  line.Finish(last);
  return EncodeExr(job->packed.frame.spec, *picture);
}

Result<std::string> RenderOnLocalFarm(const Options& options, Cancellation& cancellation) {
  const auto job = LoadSceneJob(options, Scene::Depth::kCheck);
  if (!job) return job.error();
  const Crew crew = ChooseCrew(options);
  const auto farm = LocalFarm::Start(crew.workers, crew.threads, cancellation);
  if (!farm) return farm.error();
  const auto client = CoordinatorClient::Connect((*farm)->address(), cancellation.token());
  if (!client) return client.error();
  if (auto sent = (*client)->Upload(job->packed); !sent) return sent.error();
  const auto id = (*client)->Submit(job->packed, job->packed.frame.scene_file, 0);
  if (!id) return id.error();
  const auto status = WatchWithProgress(**client, *id);
  if (!status) return status.error();
  if (status->state != JobState::kFinished) return EndedWithoutPicture(*status);
  return (*client)->FetchPicture(*id, false);
}

std::string DefaultOutput(const Options& options) {
  std::filesystem::path name = std::filesystem::path(options.scene).filename();
  if (name.extension() == ".gz") name.replace_extension();
  return name.replace_extension(".exr").string();
}

}  // namespace

Result<int> RunRender(const Options& options, Cancellation& cancellation) {
  const auto start = Clock::now();
  const std::string output = options.output.empty() ? DefaultOutput(options) : options.output;
  if (auto writable = CheckWritable(output); !writable) return writable.error();
  if (!options.png.empty()) {
    if (auto writable = CheckWritable(options.png); !writable) return writable.error();
  }
  const auto exr =
      options.in_process ? RenderHere(options, cancellation) : RenderOnLocalFarm(options, cancellation);
  if (!exr) return exr.error();
  if (auto written = WritePicture(*exr, output, options.png); !written) return written.error();
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  fmt::print(stderr, "{}: rendered in {}\n", output, DurationText(seconds));
  if (options.json) fmt::print("{}\n", PictureJson(output, Sha256(*exr), seconds));
  return 0;
}

}  // namespace tessera
