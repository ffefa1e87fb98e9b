// tessera render
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "client/commands/commands.h"
#include "client/commands/live_options.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "client/commands/print_forecast.h"
#include "client/commands/status_text.h"
#include "client/commands/times_text.h"
#include "client/commands/watching.h"
#include "client/coordinator/coordinator_client.h"
#include "client/frame_fetcher.h"
#include "client/in_process.h"
#include "client/live/farm_pictures.h"
#include "client/live/local_pictures.h"
#include "client/local_farm.h"
#include "client/notify_command.h"
#include "client/output/layer_files.h"
#include "client/output/output_target.h"
#include "client/progress_line.h"
#include "client/resume_folder.h"
#include "client/saved_picture.h"
#include "client/scene_job.h"
#include "proto/shell/console.h"
#include "proto/shell/program.h"
#include "renderer/denoise/finished_picture.h"
#include "renderer/util/cores.h"
#include "renderer/util/threads.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kProcessesMax = 1024;  // or threads on one machine: more is a typing mistake

struct RenderCommandOptions {
  SceneOptions scene;
  OutputOptions output;
  int workers = 0;  // processes; 0: chosen
  int threads = 0;  // of each process; 0: chosen
  bool in_process = false;
  bool resume = false;
  double verify_share = 0;
  std::optional<Region> first;
  LiveOptions live;
  std::string notify_command;
  bool dry_run = false;
  bool json = false;
};

void AddRenderFlags(CLI::App& app, RenderCommandOptions& options) {
  AddSceneFlags(app, options.scene);
  AddOutputFlags(app, options.output, "SCENE with the extension .exr, stdin.exr for -");
  AddInteger(app, "--workers", WithDefault("Number of worker processes", "1, or 2 with --verify"), 1,
             kProcessesMax, options.workers);
  AddInteger(app, "--threads",
             WithDefault("Render threads of each worker process", "all cores, divided among the workers"), 1,
             kProcessesMax, options.threads);
  AddSceneMemoryFlag(app, options.scene,
                     "Memory that loading one scene may take, here and in each worker process; a scene that "
                     "needs more fails",
                     "all of that of the machine or its control group, in workers half");
  AddSwitch(app, "--in-process", "Render in this process instead of on a farm", options.in_process);
  AddSwitch(app, "--resume",
            "Keep what is rendered until the pictures are finished, and continue if an earlier command with "
            "--resume was interrupted",
            options.resume);
  AddFirstFlag(app, options.first);
  AddVerifyFlag(app, options.verify_share);
  AddLiveFlags(app, options.live);
  AddNotifyFlag(app, options.notify_command);
  AddDryRunFlag(app, options.dry_run);
  AddJsonFlag(app, options.json);
}

Result<void> Check(const RenderCommandOptions& options) {
  if (options.verify_share > 0 && (options.in_process || options.workers == 1)) {
    return BadInput("--verify needs at least two workers to compare: use --workers 2 or more");
  }
  if (options.resume && options.in_process)
    return BadInput("--resume needs the processes of a local farm: leave --in-process out");
  if (options.json && TakesStandardOutput(options.output))
    return BadInput("the standard output cannot take both a picture and the answer of --json");
  return CheckPictureOptions(options.scene.render, options.output);
}

// The processes of a local farm and the threads of each.
struct FarmSize {
  int workers;
  int threads;
};

// By default one process with a thread for each core, because a scene is loaded once per process, or two
// processes if they are to verify each other.
FarmSize ChooseSize(const RenderCommandOptions& options) {
  const int workers = options.workers > 0 ? options.workers : options.verify_share > 0 ? 2 : 1;
  const int threads = options.threads > 0 ? options.threads : std::max(1, UsableCores() / workers);
  return {workers, threads};
}

// Fails if the pictures would overwrite files of the scene or do not fit their formats, or if nothing of what
// goes first is rendered.
Result<void> CheckPictures(const RenderCommandOptions& options, const SceneJob& job,
                           const PictureNames& names) {
  std::vector<int> numbers;
  for (const SceneFrame& frame : job.frames) numbers.push_back(frame.number);
  const FrameSpec& first = job.packed.frames.front().spec;
  std::set<std::string> layers;
  if (names.exr().splits_layers) {
    layers = FileLayersOf(first);
    for (const std::string& layer : LayersOfDenoising(first)) layers.insert(FileLayer(layer));
  }
  if (auto good = names.Check(numbers, job.input_paths, layers); !good) return good;
  if (auto exact = CheckCompression(first, names.exr()); !exact) return exact;
  if (auto installed = CheckInstalled(first.denoiser); !installed) return installed;
  for (const FrameRequest& frame : job.packed.frames) {
    if (auto fits = names.CheckSize(frame.spec.width, frame.spec.height); !fits) return fits;
  }
  std::vector<std::string> outputs;
  for (const int number : numbers) {
    outputs.push_back(names.Picture(number));
    if (!names.Png(number).empty()) outputs.push_back(names.Png(number));
  }
  if (auto good = CheckLive(options.live, job.input_paths, outputs); !good) return good;
  return CheckFirst(options.first, job.packed.frames);
}

LiveTitle TitleOf(const RenderCommandOptions& options) {
  return {SceneName(options.scene), options.scene.frames.has_value()};
}

// Renders frames in this process and shows how far they are.
class FrameRenderer {
 public:
  FrameRenderer(const RenderCommandOptions& options, int threads, uint32_t frames, std::stop_token stop)
      : options_(options), threads_(threads), stop_(std::move(stop)), count_{0, frames} {}

  // From now on, others watch the pictures through what is returned.
  std::shared_ptr<PictureHandoff> AddHandoff() {
    return handoffs_.emplace_back(std::make_shared<PictureHandoff>());
  }
  // Returns the finished picture as an OpenEXR file.
  Result<std::string> Render(const Scene& scene, const FrameSpec& spec, int number) {
    Progress last;
    const auto report = [&](const Progress& progress) {
      last = progress;
      last.frames = count_;
      if (progress.samples_done < progress.samples_total) line_.Show(last);
    };
    const auto offer = [&](const TakeSnapshot& take) {
      for (const auto& handoff : handoffs_) handoff->Offer(number, take);
    };
    const PixelBounds first = options_.first ? PixelsOf(*options_.first, spec) : PixelBounds{};
    auto picture = RenderInProcess(scene, spec, threads_, stop_, report, {first, offer});
    if (!picture) return picture.error();
    ++last.frames.finished;
    ++count_.finished;
    line_.Finish(last);
    auto encoded = EncodeFinished(spec, std::move(picture).value(), threads_, stop_);
    if (!encoded) return encoded.error();
    for (const auto& handoff : handoffs_) handoff->Finish(number, encoded->exr);
    return std::move(encoded->exr);
  }

 private:
  const RenderCommandOptions& options_;
  const int threads_;
  const std::stop_token stop_;
  FrameCount count_;
  ProgressLine line_{"thread"};
  std::vector<std::shared_ptr<PictureHandoff>> handoffs_;
};

// Renders the frames one after another in this process. All are checked before the first is rendered.
Result<std::vector<SavedPicture>> RenderHere(const RenderCommandOptions& options, const PictureNames& names,
                                             Cancellation& cancellation) {
  const std::stop_token stop = cancellation.token();
  const bool is_sequence = options.scene.frames.has_value();
  const FarmSize size = ChooseSize(options);
  const int threads = size.workers * size.threads;
  // Known before a large scene is loaded. Embree loads it with a thread for each core.
  if (auto can_start = CheckThreads(threads + UsableCores()); !can_start) return can_start.error();
  auto job = LoadSceneJob(options.scene, is_sequence ? Scene::Depth::kCheck : Scene::Depth::kRender, stop);
  if (!job) return job.error();
  if (auto good = CheckPictures(options, *job, names); !good) return good.error();
  FrameRenderer renderer(options, threads, static_cast<uint32_t>(job->frames.size()), stop);
  LiveViews views(stop);
  const auto viewed = AddViews(views, options.live, TitleOf(options),
                               [&] { return std::make_unique<LocalPictures>(renderer.AddHandoff()); });
  if (!viewed) return viewed.error();
  std::vector<SavedPicture> saved;
  for (size_t i = 0; i < job->frames.size(); ++i) {
    const SceneFrame& frame = job->frames[i];
    if (is_sequence) {
      job->scene = nullptr;  // frees its memory for the next one
      auto loaded = LoadFrame(frame, Scene::Depth::kRender, job->cache);
      if (!loaded) return loaded.error();
      job->scene = std::move(loaded->scene);
    }
    if (cancellation.cancelled()) return cancellation.error();
    const auto exr = renderer.Render(*job->scene, job->packed.frames[i].spec, frame.number);
    if (!exr) return exr.error();
    auto picture = SavePicture(*exr, frame.number, names, stop, IfUnsaved::kRescue);
    if (!picture) return picture.error();
    saved.push_back(std::move(*picture));
  }
  views.Finish();
  return saved;
}

uint64_t SubmissionOf(const ResumeFolder* kept) {
  return kept != nullptr ? kept->submission() : 0;
}

Result<std::vector<SavedPicture>> RenderOnLocalFarm(const RenderCommandOptions& options,
                                                    const PictureNames& names, Cancellation& cancellation) {
  const auto job = LoadSceneJob(options.scene, Scene::Depth::kCheck, cancellation.token());
  if (!job) return job.error();
  if (auto good = CheckPictures(options, *job, names); !good) return good.error();
  if (auto started = CoordinatorClient::StartThreads(); !started) return started.error();
  std::unique_ptr<ResumeFolder> kept;
  if (options.resume) {
    auto opened = ResumeFolder::Open(job->packed, Environment);
    if (!opened) return opened.error();
    kept = std::move(*opened);
    if (kept->has_data()) PrintNote("continuing what was interrupted, kept in {}\n", kept->path());
  }
  const FarmSize size = ChooseSize(options);
  const auto farm = LocalFarm::Start({size.workers, size.threads, options.scene.scene_memory}, cancellation,
                                     kept != nullptr ? kept->path() : "");
  if (!farm) return farm.error();
  const auto endpoint = ChooseFarm({(*farm)->address(), "", false});
  if (!endpoint) return endpoint.error();
  const auto client = CoordinatorClient::Connect(*endpoint, Patience{}, cancellation.token());
  if (!client) return client.error();
  if (auto sent = (*client)->Upload(job->packed); !sent) return sent.error();
  const auto id = (*client)->Submit(job->packed, {job->packed.frames[0].scene_file,
                                                  0,
                                                  {},
                                                  options.verify_share,
                                                  options.first,
                                                  SubmissionOf(kept.get())});
  if (!id) return id.error();
  LiveViews views(cancellation.token());
  const auto viewed = AddViews(views, options.live, TitleOf(options),
                               [&] { return std::make_unique<FarmPictures>(*endpoint, *id); });
  if (!viewed) return viewed.error();
  // Without --resume, the farm ends with this command, and its pictures with it.
  FrameFetcher fetcher(**client, *id, names, cancellation.token(),
                       kept != nullptr ? IfUnsaved::kFail : IfUnsaved::kRescue);
  uint32_t finished = 0;
  const auto status = WatchWithProgress(**client, *id, [&](const JobStatus& now) {
    if (now.frames_finished == finished || cancellation.cancelled()) return;
    finished = now.frames_finished;
    // Finished frames are saved even if a later one fails.
    if (auto saved = fetcher.SaveFinished(); !saved) cancellation.Cancel(saved.error());
  });
  if (!status) return status.error();
  views.Finish();
  if (auto saved = fetcher.SaveFinished(); !saved) return saved.error();
  if (status->state != JobState::kFinished) {
    if (kept != nullptr) kept->Finish();  // it would fail again
    return EndedWithoutPicture(*status);
  }
  if (const std::string line = TimesLine(status->times); !line.empty())
    PrintNote("time of the farm: {}\n", line);
  if (kept != nullptr) kept->Finish();
  return fetcher.saved();
}

// `error`: why the render ended, or null.
Notice RenderNotice(const RenderCommandOptions& options, const Error* error) {
  const bool is_interrupted = error != nullptr && error->kind == ErrorKind::kInterrupted;
  return {"", SceneName(options.scene),
          error == nullptr ? "finished"
          : is_interrupted ? "cancelled"
                           : "failed",
          error != nullptr ? error->message : ""};
}

Result<int> RunRender(const RenderCommandOptions& options, Cancellation& cancellation) {
  const auto start = Clock::now();
  const bool is_sequence = options.scene.frames.has_value();
  const std::string& output = options.output.picture;
  PictureNames names(output.empty() ? SceneName(options.scene) + ".exr" : output, options.output.png,
                     is_sequence ? PictureNames::Numbers::kAlways : PictureNames::Numbers::kNone,
                     options.output.no_clobber ? Existing::kKeep : Existing::kReplace);
  names.SetExrOutput(options.output.exr);
  const std::vector<int> numbers = is_sequence ? options.scene.frames->Numbers() : std::vector<int>{0};
  if (auto good = names.Check(numbers); !good) return good.error();
  if (options.dry_run) {
    const FarmSize size = ChooseSize(options);
    return PrintForecast(options.scene, size.workers * size.threads, options.json, cancellation);
  }
  const auto saved = options.in_process ? RenderHere(options, names, cancellation)
                                        : RenderOnLocalFarm(options, names, cancellation);
  RunNotifyCommand(options.notify_command, RenderNotice(options, saved ? nullptr : &saved.error()));
  if (!saved) return saved.error();
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const std::string count = is_sequence ? fmt::format(" {} frames", saved->size()) : "";
  PrintNote("{}:{} rendered in {}\n", ShownPath(names.picture()), count, DurationText(seconds));
  if (options.json) fmt::print("{}\n", PicturesJson(*saved, is_sequence, seconds));
  return 0;
}

}  // namespace

Command RenderCommand() {
  return MakeCommand<RenderCommandOptions>({
      .name = "render",
      .summary = "Render a scene on this machine",
      .examples = {{"Render with the settings of the scene", "tessera render scene.pbrt -o picture.exr"},
                   {"Render a quick draft to look at",
                    "tessera render scene.pbrt --spp 16 --resolution 640x360 --png draft.png"},
                   {"Render frames 1 to 240, one scene file each",
                    "tessera render shot.####.pbrt --frames 1-240 -o out.####.exr"},
                   {"Render a draft without noise", "tessera render scene.pbrt --spp 64 --denoise"},
                   {"Stop sampling where the picture is clean",
                    "tessera render scene.pbrt --spp 4096 --noise-threshold 0.05"},
                   {"Render the middle of the picture first",
                    "tessera render scene.pbrt --first 0.25,0.75,0.25,0.75"},
                   {"Look at the picture while it is rendered",
                    "tessera render scene.pbrt --preview preview.png"},
                   {"Look at it in tev", "tessera render scene.pbrt --display tev://localhost:14158"}},
      .add_flags = AddRenderFlags,
      .check = Check,
      .run = RunRender,
  });
}

}  // namespace tessera
