#include "client/in_process.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "renderer/film/adaptive.h"

namespace tessera {
namespace {

// Pixel samples of a unit: less than a tenth of a second of one thread, so that all threads finish together,
// and far more than the cost of merging.
constexpr int64_t kUnitSamplesMax = 1 << 16;
constexpr std::chrono::milliseconds kReportInterval{100};

// The largest number of samples per pixel in a unit of the frame.
uint32_t UnitSizeMax(const FrameSpec& spec) {
  const int64_t tile_area = std::min(spec.TileBounds(0).area(), kUnitSamplesMax);
  return std::bit_floor(static_cast<uint32_t>(kUnitSamplesMax / tile_area));
}

// Threads that take units one after another and merge the results.
class ThreadPool {
 public:
  ThreadPool(const Scene& scene, const FrameSpec& spec, int threads)
      : scene_(scene), spec_(spec), merger_(spec), unit_size_max_(UnitSizeMax(spec)), running_(threads) {
    for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { Work(); });
  }
  ~ThreadPool() { Join(); }
  void Stop() {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    work_.notify_all();
  }
  // Waits for kReportInterval or until all threads are done, and returns whether they are. Stores the numbers
  // of pixel samples in `progress`.
  bool WaitForEnd(Progress& progress) {
    std::unique_lock lock(mutex_);
    done_.wait_for(lock, kReportInterval, [this] { return running_ == 0; });
    progress.samples_done = merger_.samples_merged();
    progress.samples_total = merger_.samples_total();
    return running_ == 0;
  }
  const Merger& TakeMerger() {
    Join();
    return merger_;
  }

 private:
  struct Unit {
    int tile;
    SampleRange range;
    PixelMask pixels;
  };
  // Samples of a tile that no thread has taken yet.
  struct Open {
    int tile;
    uint32_t begin, end;
  };

  void Join() {
    for (std::thread& thread : threads_) {
      if (thread.joinable()) thread.join();
    }
  }
  void Work() {
    std::unique_lock lock(mutex_);
    while (const auto unit = Take(lock)) {
      lock.unlock();
      auto sums = scene_.Render(spec_.TileBounds(unit->tile), unit->pixels, unit->range, &stop_);
      lock.lock();
      if (!sums) break;
      Merge(unit->tile, std::move(*sums));
    }
    work_.notify_all();
    if (--running_ == 0) done_.notify_all();
  }
  // Waits while no unit is open but results that are being rendered may open more. Returns nullopt if nothing
  // is left to do.
  std::optional<Unit> Take(std::unique_lock<std::mutex>& lock) {
    const int tile_count = spec_.TileCount();
    work_.wait(lock, [&] { return stop_ || !open_.empty() || tile_next_ < tile_count || taken_ == 0; });
    if (stop_ || (open_.empty() && tile_next_ == tile_count)) return std::nullopt;
    if (open_.empty()) {
      open_.push_back({tile_next_, 0, merger_.Goal(tile_next_).samples});
      ++tile_next_;
    }
    Open& open = open_.back();
    uint32_t size = std::min(unit_size_max_, DyadicSizeMax(open.begin, open.end));
    if (open.begin == 0) size = std::min(size, FirstUnitMax(spec_));
    const Unit unit{open.tile, {open.begin, size}, merger_.Goal(open.tile).pixels};
    open.begin += size;
    if (open.begin == open.end) open_.pop_back();
    ++taken_;
    return unit;
  }
  void Merge(int tile, RadianceTile sums) {
    --taken_;
    const uint32_t before = merger_.Goal(tile).samples;
    TESSERA_CHECK(merger_.Add(tile, std::move(sums)).has_value());
    const uint32_t after = merger_.Goal(tile).samples;
    if (after > before) open_.push_back({tile, before, after});
    work_.notify_all();
  }

  const Scene& scene_;
  const FrameSpec& spec_;
  Merger merger_;  // guarded by mutex_, as all that follows
  const uint32_t unit_size_max_;
  std::vector<Open> open_;  // a stack: a tile is finished before another is started
  int tile_next_ = 0;       // the first tile that has not been started
  int taken_ = 0;           // units being rendered
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::condition_variable work_, done_;
  int running_;
  std::vector<std::thread> threads_;
};

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Result<FramePicture> RenderInProcess(const Scene& scene, const FrameSpec& spec, int threads,
                                     std::stop_token stop,
                                     const std::function<void(const Progress&)>& report) {
  const auto start = std::chrono::steady_clock::now();
  ThreadPool pool(scene, spec, threads);
  const std::stop_callback on_stop(stop, [&pool] { pool.Stop(); });
  Progress progress;
  progress.workers = threads;
  for (bool done = false; !done;) {
    done = pool.WaitForEnd(progress);
    progress.elapsed_s = SecondsSince(start);
    progress.samples_per_second = static_cast<double>(progress.samples_done) / progress.elapsed_s;
    const double left = static_cast<double>(progress.samples_total - progress.samples_done);
    progress.left_s = progress.samples_done > 0 ? left / progress.samples_per_second : -1;
    report(progress);
  }
  const Merger& merger = pool.TakeMerger();
  if (!merger.Complete()) return Error{ErrorKind::kInterrupted, "interrupted"};
  return merger.Picture();
}

}  // namespace tessera
