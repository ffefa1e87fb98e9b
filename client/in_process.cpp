#include "client/in_process.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>

#include "proto/terms.h"
#include "renderer/film/unit_queue.h"
#include "renderer/util/seconds_since.h"
#include "renderer/util/threads.h"

namespace tessera {
namespace {

// Pixel samples of a unit: less than a tenth of a second of one thread, so that all threads finish together,
// and far more than the cost of merging.
constexpr int64_t kUnitSamplesMax = 1 << 16;
constexpr std::chrono::milliseconds kReportInterval{100};

// Threads that take units one after another and merge the results.
class ThreadPool {
 public:
  ThreadPool(const Scene& scene, const FrameSpec& spec, const PixelBounds& first)
      : scene_(scene),
        spec_(spec),
        queue_(spec, kUnitSamplesMax, [first](const PixelBounds& tile) { return Overlap(tile, first); }),
        threads_([this](Error why) { Fail(std::move(why)); }) {}
  ~ThreadPool() { Stop(); }
  Result<void> Start(int threads) {
    for (int i = 0; i < threads; ++i) {
      {
        const std::lock_guard lock(mutex_);
        ++running_;
      }
      if (auto started = threads_.Start([this] { Work(); }); !started) {
        const std::lock_guard lock(mutex_);
        --running_;
        return started;
      }
    }
    return {};
  }
  void Stop() {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    changed_.notify_all();
  }
  // Waits for kReportInterval or until all threads are done, and returns whether they are. Stores the numbers
  // of pixel samples in `progress`.
  bool WaitForEnd(Progress& progress) {
    std::unique_lock lock(mutex_);
    done_.wait_for(lock, kReportInterval, [this] { return running_ == 0; });
    progress.samples_done = queue_.merger().samples_merged();
    progress.samples_total = queue_.merger().samples_total();
    return running_ == 0;
  }
  FrameSnapshot Snapshot() {
    const std::lock_guard lock(mutex_);
    return queue_.merger().Snapshot();
  }
  // The error of a thread, if there was one.
  Result<const Merger*> TakeMerger() {
    threads_.Join();
    if (error_) return *error_;
    return &queue_.merger();
  }

 private:
  void Fail(Error why) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::move(why);
    stop_ = true;
    --running_;
    changed_.notify_all();
    done_.notify_all();
  }
  // An exception, such as std::bad_alloc, ends the thread and is reported to Fail.
  void Work() {
    std::unique_lock lock(mutex_);
    while (const auto unit = Take(lock)) {
      lock.unlock();
      auto sums = scene_.Render(spec_.TileBounds(unit->tile), unit->pixels, unit->range, &stop_);
      lock.lock();
      if (!sums) break;
      queue_.Merge(*unit, std::move(*sums));
      changed_.notify_all();
    }
    changed_.notify_all();
    if (--running_ == 0) done_.notify_all();
  }
  // Waits while there is no unit but units that are being rendered may make more wanted. Returns nullopt if
  // nothing is left to do or a stop is requested.
  std::optional<UnitQueue::Unit> Take(std::unique_lock<std::mutex>& lock) {
    changed_.wait(lock, [this] { return stop_ || queue_.HasUnit() || queue_.taken() == 0; });
    if (stop_) return std::nullopt;
    return queue_.Take();
  }

  const Scene& scene_;
  const FrameSpec& spec_;
  UnitQueue queue_;  // guarded by mutex_
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::condition_variable changed_, done_;
  int running_ = 0;             // guarded by mutex_
  std::optional<Error> error_;  // guarded by mutex_
  ThreadGroup threads_;
};

}  // namespace

Result<FramePicture> RenderInProcess(const Scene& scene, const FrameSpec& spec, int threads,
                                     std::stop_token stop, const std::function<void(const Progress&)>& report,
                                     const InProcessOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  ThreadPool pool(scene, spec, options.first);
  if (auto started = pool.Start(threads); !started) return started.error();
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
    if (options.offer && !done) options.offer([&pool] { return pool.Snapshot(); });
  }
  const auto merger = pool.TakeMerger();
  if (!merger) return merger.error();
  if (!(*merger)->Complete()) return Error{ErrorKind::kInterrupted, "interrupted"};
  return (*merger)->Picture();
}

}  // namespace tessera
