#include "client/in_process.h"

#include <algorithm>
#include <atomic>
#include <climits>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace tessera {
namespace {

// Pixel samples of a unit: below a tenth of a second of one thread, so that all threads finish together, and
// far above the cost of merging.
constexpr int64_t kUnitSamplesMax = 1 << 16;
constexpr std::chrono::milliseconds kReportInterval{100};

// The ranges in which every tile is rendered, in order.
std::vector<SampleRange> CutSamples(const FrameSpec& spec) {
  const int64_t tile_area = std::min(spec.TileBounds(0).area(), kUnitSamplesMax);
  const uint32_t size_max = std::bit_floor(static_cast<uint32_t>(kUnitSamplesMax / tile_area));
  std::vector<SampleRange> ranges;
  for (SampleRange term : DyadicPartition(spec.samples_per_pixel)) {
    const uint32_t size = std::min(term.size, size_max);
    for (uint32_t begin = term.begin; begin < term.end(); begin += size) ranges.push_back({begin, size});
  }
  return ranges;
}

// Threads that take units one after another and merge what they render.
class Crew {
 public:
  Crew(const Scene& scene, const FrameSpec& spec, int threads)
      : scene_(scene), merger_(spec), ranges_(CutSamples(spec)), running_(threads) {
    for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { Work(); });
  }
  ~Crew() { Join(); }
  void Stop() { stop_ = true; }
  // Waits a moment; whether all threads are done. `merged` becomes the count of pixel samples merged.
  bool WaitForEnd(uint64_t& merged) {
    std::unique_lock lock(mutex_);
    done_.wait_for(lock, kReportInterval, [this] { return running_ == 0; });
    merged = merger_.samples_merged();
    return running_ == 0;
  }
  const Merger& TakeMerger() {
    Join();
    return merger_;
  }

 private:
  void Join() {
    for (std::thread& thread : threads_) {
      if (thread.joinable()) thread.join();
    }
  }
  void Work() {
    while (!stop_) {
      const uint64_t index = next_.fetch_add(1);
      const int tile = static_cast<int>(std::min<uint64_t>(index / ranges_.size(), INT_MAX));
      if (tile >= merger_.spec().TileCount()) break;
      auto sums = scene_.Render(merger_.spec().TileBounds(tile), ranges_[index % ranges_.size()], &stop_);
      if (!sums) break;
      const std::lock_guard lock(mutex_);
      TESSERA_CHECK(merger_.Add(tile, std::move(*sums)).has_value());
    }
    const std::lock_guard lock(mutex_);
    if (--running_ == 0) done_.notify_all();
  }

  const Scene& scene_;
  Merger merger_;  // guarded by mutex_, its spec aside
  const std::vector<SampleRange> ranges_;
  std::atomic<uint64_t> next_ = 0;  // unit: tile by tile, in each range by range
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::condition_variable done_;
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
  Crew crew(scene, spec, threads);
  const std::stop_callback on_stop(stop, [&crew] { crew.Stop(); });
  Progress progress;
  progress.samples_total = static_cast<uint64_t>(spec.crop.area()) * spec.samples_per_pixel;
  progress.workers = threads;
  for (bool done = false; !done;) {
    done = crew.WaitForEnd(progress.samples_done);
    progress.elapsed_s = SecondsSince(start);
    progress.samples_per_second = static_cast<double>(progress.samples_done) / progress.elapsed_s;
    const double left = static_cast<double>(progress.samples_total - progress.samples_done);
    progress.left_s = progress.samples_done > 0 ? left / progress.samples_per_second : -1;
    report(progress);
  }
  const Merger& merger = crew.TakeMerger();
  if (!merger.Complete()) return Error{ErrorKind::kInterrupted, "interrupted"};
  return merger.Picture();
}

}  // namespace tessera
