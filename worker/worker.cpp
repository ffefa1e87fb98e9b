#include "worker/worker.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <condition_variable>
#include <cstdlib>
#include <exception>

#include "proto/shell/system.h"
#include "proto/wire/channel.h"
#include "renderer/film/radiance_tile.h"
#include "renderer/scene/probe.h"
#include "renderer/util/check.h"
#include "worker/build_id.h"
#include "worker/scene_loader.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

// Textures and meshes of the last scenes, decoded: the next frame needs most of them again. Those of large
// scenes fit.
constexpr uint64_t kAssetBytesMax = uint64_t{2} << 30;

// The parts of a drain; together below the 10 s that are promised.
constexpr std::chrono::milliseconds kFinishPatience{5000};  // for units that are being rendered
constexpr std::chrono::milliseconds kReturnPatience{2500};  // for what is left to be returned
constexpr std::chrono::milliseconds kGoodbyePatience{1000};
constexpr std::chrono::milliseconds kLoaderPatience{500};

std::string ProbeDigest() {
  const auto start = Clock::now();
  const auto digest = RenderProbe();
  TESSERA_CHECK(digest);
  spdlog::debug("probe digest={} render_s={:.3f}", digest->Hex(),
                std::chrono::duration<double>(Clock::now() - start).count());
  return {digest->bytes.begin(), digest->bytes.end()};
}

WorkerState Introduce(const WorkerOptions& options) {
  WorkerState self;
  self.worker = WorkerId{RandomId()};
  self.name = options.name;
  self.slots = options.threads;
  self.build_digest = BuildId();
  self.probe_digest = ProbeDigest();
  self.tags = options.tags;
  return self;
}

// Waits until one of them asks to stop.
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

// Whether the lease asks for a unit of the scene's frame, or of what the frame may be extended to.
bool Fits(const Lease& lease, const Scene& scene) {
  const FrameSpec& frame = scene.frame();
  const auto tiles = static_cast<uint32_t>(frame.TileCount());
  const bool has_samples = lease.unit.range.end() <= frame.samples_per_pixel || scene.summary().extendable;
  return lease.unit.tile < tiles && lease.bounds == frame.TileBounds(static_cast<int>(lease.unit.tile)) &&
         lease.unit.range.IsDyadic() && has_samples;
}

// Renders one unit on this thread.
void RenderUnit(const UnitTask& task, Workbench& bench) {
  const auto start = Clock::now();
  if (!Fits(task.lease, *task.scene)) {
    return bench.UnitFailed(task.lease, task.lease.unit.Text() + " is not a unit of its scene");
  }
  const auto tile =
      task.scene->Render(task.lease.bounds, task.lease.pixels, task.lease.unit.range, task.stop.get());
  if (!tile) return bench.UnitStopped(task.lease.id);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  bench.UnitFinished({task.lease.id, task.lease.unit, EncodeRadianceTile(*tile), seconds});
}

}  // namespace

Worker::Worker(const WorkerOptions& options)
    : states_channel_(OpenChannel(options.coordinator)),
      bulk_channel_(OpenChannel(options.coordinator)),
      self_(Introduce(options)),
      threads_(options.threads),
      meter_(threads_, Clock::now()),
      cache_(options.cache_dir, options.cache_bytes),
      fetcher_(bulk_channel_, cache_, closing_.get_token(), Number(self_.worker) + 2,
               [this](uint64_t bytes) { meter_.Fetched(bytes); }),
      assets_(std::make_shared<SharedCache>(kAssetBytesMax)),
      prefetcher_(fetcher_),
      bench_([this] { synchronizer_.Ring(); }),
      synchronizer_(states_channel_, self_, bench_, meter_, prefetcher_,
                    [this](Error why) { OnRefusal(std::move(why)); }),
      returner_(bulk_channel_, self_.worker, bench_, [this](Error why) { OnRefusal(std::move(why)); }) {}

Worker::~Worker() {
  closing_.request_stop();
  bench_.StopRendering();
  for (std::thread& thread : crew_) thread.join();
  if (loader_.joinable()) loader_.join();
}

void Worker::OnRefusal(Error why) {
  {
    const std::lock_guard lock(mutex_);
    if (!refusal_) refusal_ = std::move(why);
  }
  refused_.request_stop();
}

Result<void> Worker::Run(std::stop_token stop) {
  spdlog::info("worker_started worker={:016x} name=\"{}\" slots={}", Number(self_.worker), self_.name,
               threads_);
  loader_ = std::thread([this] { LoadScenes(); });
  crew_.emplace_back([this] { synchronizer_.Run(closing_.get_token()); });
  crew_.emplace_back([this] { returner_.Run(closing_.get_token()); });
  crew_.emplace_back([this] { prefetcher_.Run(closing_.get_token()); });
  for (int i = 0; i < threads_; ++i) crew_.emplace_back([this] { Render(); });
  AwaitEither(stop, refused_.get_token());
  if (!refused_.stop_requested()) Drain();
  closing_.request_stop();
  bench_.StopRendering();
  for (std::thread& thread : crew_) thread.join();
  crew_.clear();
  std::optional<Error> refusal;
  {
    const std::lock_guard lock(mutex_);
    refusal = refusal_;
  }
  if (refusal) return *refusal;
  synchronizer_.SayGoodbye(kGoodbyePatience);
  return {};
}

bool Worker::IsLoading() {
  std::unique_lock lock(mutex_);
  return !loader_ended_.wait_for(lock, kLoaderPatience, [this] { return loader_is_done_; });
}

void Worker::Drain() {
  spdlog::info("draining");
  bench_.Drain();
  if (bench_.AwaitIdle(kFinishPatience)) return;
  bench_.StopRendering();
  if (!bench_.AwaitIdle(kReturnPatience))
    spdlog::warn("drain_failed reason=\"not everything could be returned\"");
}

void Worker::Render() {
  while (const auto task = bench_.AwaitUnit(closing_.get_token())) {
    meter_.SlotBegins(Clock::now());
    try {
      RenderUnit(*task, bench_);
    } catch (const std::exception& e) {  // out of memory
      bench_.UnitFailed(task->lease, fmt::format("{}: {}", task->lease.unit.Text(), e.what()));
    }
    meter_.SlotEnds(Clock::now());
  }
}

// What is not here afterwards is fetched when the scene calls it.
void Worker::FetchFiles(const SceneOrder& order) {
  if (!order.needs_all) return;
  meter_.LoaderDoes(ActivityMeter::Loader::kFetching, Clock::now());
  synchronizer_.Ring();
  const auto fetched = fetcher_.FetchPackage(order.package);
  if (fetched || closing_.stop_requested()) return;
  spdlog::warn("fetch_failed package={} reason=\"{}\"", order.package.Hex(), fetched.error().message);
}

void Worker::LoadScenes() {
  const FetchBlob fetch = [this](const Digest& digest, uint64_t size_max) {
    return fetcher_.Get(digest, size_max);
  };
  while (const auto order = bench_.AwaitSceneOrder(closing_.get_token())) {
    const auto start = Clock::now();
    try {
      FetchFiles(*order);
      if (closing_.stop_requested()) break;
      meter_.LoaderDoes(ActivityMeter::Loader::kLoading, Clock::now());
      synchronizer_.Ring();
      auto scene = LoadOrderedScene(*order, fetch, assets_);
      meter_.LoaderDoes(ActivityMeter::Loader::kIdle, Clock::now());
      if (closing_.stop_requested()) break;
      if (!scene) {
        spdlog::warn("scene_failed scene={} reason=\"{}\"", order->key.Hex(), scene.error().message);
        bench_.SceneFailed(order->key, scene.error().message);
        continue;
      }
      bench_.SceneLoaded(order->key, std::move(*scene));
    } catch (const std::exception& e) {  // out of memory
      meter_.LoaderDoes(ActivityMeter::Loader::kIdle, Clock::now());
      bench_.SceneFailed(order->key, fmt::format("{}: {}", order->scene_file, e.what()));
      continue;
    }
    spdlog::info("scene_loaded scene={} load_s={:.3f}", order->key.Hex(),
                 std::chrono::duration<double>(Clock::now() - start).count());
  }
  const std::lock_guard lock(mutex_);
  loader_is_done_ = true;
  loader_ended_.notify_all();
}

}  // namespace tessera
