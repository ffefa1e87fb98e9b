#include "worker/worker.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <initializer_list>

#include "proto/shell/system.h"
#include "proto/wire/channel.h"
#include "renderer/film/radiance_tile.h"
#include "renderer/scene/probe.h"
#include "renderer/text/unicode.h"
#include "renderer/util/cores.h"
#include "worker/build_id.h"
#include "worker/farm_login.h"
#include "worker/machine_id.h"
#include "worker/probe_note.h"
#include "worker/scene_loader.h"
#include "worker/scene_preparation.h"

namespace tessera {
namespace {

PreparationReport NotPrepared(const Digest& key, std::string reason) {
  PreparationReport report;
  report.key = key;
  report.reason = std::move(reason);
  return report;
}

using Clock = std::chrono::steady_clock;

// Besides those that render or build a scene, with those that gRPC and parallel downloads start.
constexpr int kThreadsOfWorker = 24;

constexpr auto kNews = SharedWorkload::News::kYes;

// Decoded textures and meshes of the last scenes: the next frame needs most of them again. Those of large
// scenes fit.
constexpr uint64_t kAssetBytesMax = uint64_t{2} << 30;

// The parts of a drain; together less than the 10 s that are promised.
constexpr std::chrono::milliseconds kFinishPatience{5000};  // for units that are being rendered
constexpr std::chrono::milliseconds kReturnPatience{2500};  // for results that have not been sent
constexpr std::chrono::milliseconds kLeavePatience{1000};
constexpr std::chrono::milliseconds kLoaderPatience{500};

Result<std::string> ProbeDigest(const WorkerOptions& options) {
  const auto start = Clock::now();
  const auto circumstances = options.probe_dir.empty() ? std::nullopt : ProbeCircumstances();
  const auto digest =
      NotedProbe(options.probe_dir, circumstances, [&] { return RenderProbe(options.threads); });
  if (!digest) return Failed("this machine cannot render: " + digest.error().message);
  spdlog::debug("probe digest={} render_s={:.3f}", digest->Hex(),
                std::chrono::duration<double>(Clock::now() - start).count());
  return std::string(digest->bytes.begin(), digest->bytes.end());
}

Result<WorkerState> DescribeSelf(const WorkerOptions& options) {
  WorkerState self;
  self.worker = WorkerId{RandomId()};
  self.name = options.name;
  self.slots = options.threads;
  self.build_digest = BuildId();
  auto probe_digest = ProbeDigest(options);
  if (!probe_digest) return probe_digest.error();
  self.probe_digest = std::move(*probe_digest);
  self.tags = options.tags;
  self.machine = MachineId();
  return self;
}

// Waits until one of them requests a stop.
void AwaitEither(std::stop_token one, std::stop_token other) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  const std::stop_callback on_other(other, [&] {
    const std::lock_guard lock(mutex);
    stopped.notify_all();
  });
  std::unique_lock lock(mutex);
  stopped.wait(lock, one, [&] { return other.stop_requested(); });
}

// Whether the leased unit is one of the scene's frame, or of what the frame may be extended to.
bool Fits(const Lease& lease, const Scene& scene) {
  const FrameSpec& frame = scene.frame();
  const auto tiles = static_cast<uint32_t>(frame.TileCount());
  const bool has_samples = lease.unit.range.end() <= frame.samples_per_pixel || scene.summary().extendable;
  return lease.unit.tile < tiles && lease.bounds == frame.TileBounds(static_cast<int>(lease.unit.tile)) &&
         lease.unit.range.IsDyadic() && has_samples;
}

// Renders one unit on this thread.
void RenderUnit(const UnitTask& task, SharedWorkload& workload) {
  const auto start = Clock::now();
  if (!Fits(task.lease, *task.scene)) {
    return workload.Change()->UnitFailed(task.lease, task.lease.unit.Text() + " is not a unit of its scene");
  }
  const auto tile =
      task.scene->Render(task.lease.bounds, task.lease.pixels, task.lease.unit.range, task.stop.get());
  if (!tile) return workload.Change()->UnitStopped(task.lease.id);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  FinishedUnit finished{task.lease.id, task.lease.unit, EncodeRadianceTile(*tile), seconds};
  workload.Change()->UnitFinished(std::move(finished), Clock::now());
}

}  // namespace

Result<std::unique_ptr<Worker>> Worker::Make(const WorkerOptions& options, const Endpoint& coordinator,
                                             BlobStore cache) {
  if (auto can_start = CheckThreads(options.threads + UsableCores() + kThreadsOfWorker); !can_start)
    return can_start.error();
  auto self = DescribeSelf(options);
  if (!self) return self.error();
  return std::unique_ptr<Worker>(new Worker(options, coordinator, std::move(*self), std::move(cache)));
}

Worker::Worker(const WorkerOptions& options, const Endpoint& coordinator, WorkerState self, BlobStore cache)
    : login_(coordinator.login),
      states_channel_(OpenChannel(coordinator)),
      bulk_channel_(OpenChannel(coordinator)),
      self_(std::move(self)),
      threads_(options.threads),
      load_limits_(options.load_limits),
      meter_(threads_, Clock::now()),
      cache_(std::move(cache)),
      fetcher_(bulk_channel_, cache_, closing_.get_token(), Number(self_.worker) + 2,
               [this](uint64_t bytes) { meter_.Fetched(bytes); }),
      assets_(std::make_shared<SharedCache>(kAssetBytesMax)),
      prefetcher_(fetcher_),
      workload_([this] { synchronizer_.NotifyNews(); }),
      synchronizer_(states_channel_, coordinator, self_, workload_, meter_, prefetcher_,
                    [this](Error why) { OnRefusal(std::move(why)); }),
      sender_(bulk_channel_, self_.worker, workload_),
      pool_([this](Error why) { OnRefusal(std::move(why)); }),
      loader_([this](Error why) { OnRefusal(std::move(why)); }) {}

Worker::~Worker() {
  closing_.request_stop();
  workload_.Change(kNews)->StopRendering();
  pool_.Join();
  loader_.Join();
}

void Worker::OnRefusal(Error why) {
  {
    const std::lock_guard lock(mutex_);
    if (!refusal_) refusal_ = std::move(why);
  }
  refused_.request_stop();
}

Result<void> Worker::Run(std::stop_token stop) {
  spdlog::info("worker_started worker={:016x} name={} slots={}", Number(self_.worker), LogText(self_.name),
               threads_);
  if (auto started = StartThreads(); !started) {
    OnRefusal(started.error());
  }
  AwaitEither(stop, refused_.get_token());
  if (!refused_.stop_requested()) Drain();
  closing_.request_stop();
  workload_.Change(kNews)->StopRendering();
  pool_.Join();
  std::optional<Error> refusal;
  {
    const std::lock_guard lock(mutex_);
    refusal = refusal_;
  }
  if (refusal) return *refusal;
  synchronizer_.Leave(kLeavePatience);
  return {};
}

Result<void> Worker::StartThreads() {
  if (auto started = loader_.Start([this] { LoadScenes(); }); !started) {
    loader_is_done_ = true;
    return started;
  }
  for (int i = 0; i < threads_; ++i) {
    if (auto started = pool_.Start([this] { Render(); }); !started) return started;
  }
  // The coordinator learns of this worker when it can work.
  for (const std::function<void()>& run : std::initializer_list<std::function<void()>>{
           [this] { prefetcher_.Run(closing_.get_token()); }, [this] { sender_.Run(closing_.get_token()); },
           [this] { synchronizer_.Run(closing_.get_token()); }}) {
    if (auto started = pool_.Start(run); !started) return started;
  }
  if (!login_) return {};
  return pool_.Start([this] { KeepLoginRenewed(*login_, bulk_channel_, closing_.get_token()); });
}

bool Worker::IsLoading() {
  std::unique_lock lock(mutex_);
  return !loader_ended_.wait_for(lock, kLoaderPatience, [this] { return loader_is_done_; });
}

void Worker::Drain() {
  spdlog::info("draining");
  workload_.Change(kNews)->Drain();
  if (workload_.AwaitIdle(kFinishPatience)) return;
  workload_.Change(kNews)->StopRendering();
  if (!workload_.AwaitIdle(kReturnPatience))
    spdlog::warn("drain_incomplete reason=\"some results could not be returned\"");
}

void Worker::Render() {
  while (const auto task = workload_.AwaitUnit(closing_.get_token())) {
    meter_.SlotBegins(Clock::now());
    try {
      RenderUnit(*task, workload_);
    } catch (const std::exception& e) {  // such as std::bad_alloc
      workload_.Change()->UnitFailed(task->lease, fmt::format("{}: {}", task->lease.unit.Text(), e.what()));
    }
    meter_.SlotEnds(Clock::now());
  }
}

// Files that are missing afterwards are fetched when the scene reads them.
void Worker::FetchFiles(const SceneRequest& order) {
  if (!order.needs_all) return;
  meter_.LoaderDoes(ActivityMeter::Loader::kFetching, Clock::now());
  synchronizer_.NotifyNews();
  const auto fetched = fetcher_.FetchPackage(order.package);
  if (fetched || closing_.stop_requested()) return;
  spdlog::warn("fetch_failed package={} reason={}", order.package.Hex(), LogText(fetched.error().message));
}

void Worker::LoadScene(const SceneRequest& order) {
  const auto start = Clock::now();
  FetchFiles(order);
  if (closing_.stop_requested()) return;
  meter_.LoaderDoes(ActivityMeter::Loader::kLoading, Clock::now());
  synchronizer_.NotifyNews();
  const FetchBlob fetch = [&](const Digest& digest, uint64_t size_max) {
    return fetcher_.Get(order.package, digest, size_max);
  };
  LoadOutcome loaded = LoadOrderedScene(order, load_limits_, fetch, assets_);
  meter_.LoaderDoes(ActivityMeter::Loader::kIdle, Clock::now());
  if (closing_.stop_requested()) return;
  if (loaded.scene == nullptr) {
    spdlog::warn("scene_failed scene={} reason={}", order.key.Hex(), LogText(loaded.reason));
    return workload_.Change(kNews)->SceneFailed(order.key, loaded.reason, loaded.cause, Clock::now());
  }
  workload_.Change(kNews)->SceneLoaded(order.key, std::move(loaded.scene));
  spdlog::info("scene_loaded scene={} load_s={:.3f}", order.key.Hex(),
               std::chrono::duration<double>(Clock::now() - start).count());
}

void Worker::Prepare(const PreparationRequest& request) {
  const auto start = Clock::now();
  meter_.LoaderDoes(ActivityMeter::Loader::kLoading, Clock::now());
  const FetchBlob fetch = [&](const Digest& digest, uint64_t size_max) {
    return fetcher_.Get(request.scene.package, digest, size_max);
  };
  auto report = LoadWithinLimits(request.scene.scene_file, load_limits_,
                                 [&] { return PrepareScene(request, fetch, assets_); });
  if (closing_.stop_requested()) return;
  const double load_s = std::chrono::duration<double>(Clock::now() - start).count();
  if (report) {
    spdlog::info("scene_prepared key={} frames={} load_s={:.3f}", request.key.Hex(), report->frames.size(),
                 load_s);
  } else {
    spdlog::warn("scene_not_prepared key={} load_s={:.3f} reason={}", request.key.Hex(), load_s,
                 LogText(report.error().message));
    report = NotPrepared(request.key, report.error().message);
  }
  workload_.Change(kNews)->PreparationFinished(std::move(*report));
}

void Worker::LoadScenes() {
  while (const auto task = workload_.AwaitLoaderTask(closing_.get_token())) {
    const auto* const scene = std::get_if<SceneRequest>(&*task);
    const auto* const preparation = std::get_if<PreparationRequest>(&*task);
    try {
      scene != nullptr ? LoadScene(*scene) : Prepare(*preparation);
    } catch (const std::exception& e) {  // such as std::bad_alloc
      if (scene != nullptr) {
        workload_.Change(kNews)->SceneFailed(scene->key, fmt::format("{}: {}", scene->scene_file, e.what()),
                                             FailureCause::kWorkerLimit, Clock::now());
      } else {
        workload_.Change(kNews)->PreparationFinished(
            NotPrepared(preparation->key, fmt::format("{}: {}", preparation->scene.scene_file, e.what())));
      }
    }
    meter_.LoaderDoes(ActivityMeter::Loader::kIdle, Clock::now());
  }
  const std::lock_guard lock(mutex_);
  loader_is_done_ = true;
  loader_ended_.notify_all();
}

}  // namespace tessera
