#include "tests/bench/frame_run.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "renderer/film/unit_queue.h"

namespace tessera {
namespace {

// Pixel samples of a unit, so large that the costs of a unit do not show.
constexpr int64_t kUnitSamplesMax = 1 << 20;
constexpr double kOutliers = 0.001;  // share of values that `trimmed` omits

// Of channels R, G, B, in this order.
std::vector<size_t> ChannelPlaces(const std::vector<std::string>& channels) {
  std::vector<size_t> places;
  for (const char* name : {"R", "G", "B"}) {
    places.push_back(
        static_cast<size_t>(std::find(channels.begin(), channels.end(), name) - channels.begin()));
  }
  return places;
}

// R, G, B of every pixel, one after the other.
std::vector<double> ColorsOf(const std::vector<float>& values, const std::vector<std::string>& channels) {
  const std::vector<size_t> places = ChannelPlaces(channels);
  std::vector<double> colors;
  for (size_t pixel = 0; pixel < values.size() / channels.size(); ++pixel) {
    for (const size_t place : places) colors.push_back(values[pixel * channels.size() + place]);
  }
  return colors;
}

double MeanOfFirst(const std::vector<double>& values, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; ++i) sum += values[i];
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

}  // namespace

double CpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double WallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

FrameRun RenderWhole(const Scene& scene, int threads) {
  const FrameSpec& frame = scene.frame();
  FrameRun run;
  const double cpu_start = CpuSeconds(), wall_start = WallSeconds();
  UnitQueue queue(frame, kUnitSamplesMax);
  std::mutex mutex;
  std::condition_variable added;
  std::vector<std::thread> pool;
  for (int t = 0; t < threads; ++t) {
    pool.emplace_back([&] {
      RenderStatistics own;
      std::unique_lock lock(mutex);
      while (true) {
        added.wait(lock, [&] { return queue.HasUnit() || queue.taken() == 0; });
        const auto unit = queue.Take();
        if (!unit) break;
        lock.unlock();
        auto values = scene.Render(frame.TileBounds(unit->tile), unit->pixels, unit->range, nullptr, &own);
        lock.lock();
        queue.Merge(*unit, std::move(*values));
        added.notify_all();
      }
      run.rays.camera_rays += own.camera_rays;
      run.rays.bounce_rays += own.bounce_rays;
      run.rays.shadow_rays += own.shadow_rays;
      run.rays.discarded_samples += own.discarded_samples;
    });
  }
  for (std::thread& thread : pool) thread.join();
  run.cpu_seconds = CpuSeconds() - cpu_start;
  run.wall_seconds = WallSeconds() - wall_start;
  run.picture = queue.merger().Picture();
  return run;
}

Result<References> References::Load(const std::string& paths) {
  References references;
  const size_t comma = paths.find(',');
  for (const std::string& path :
       {paths.substr(0, comma), comma == std::string::npos ? std::string() : paths.substr(comma + 1)}) {
    if (path.empty()) continue;
    Result<LoadedPicture> picture = LoadExr(path);
    if (!picture) return picture.error();
    if (!references.pictures.empty() && references.pictures[0].values.size() != picture->values.size()) {
      return BadInput(path + ": size differs from that of " + paths.substr(0, comma));
    }
    references.pictures.push_back(std::move(*picture));
  }
  return references;
}

RelativeError RelativeErrorOf(const FramePicture& picture, const References& references) {
  const LoadedPicture &first = references.pictures.front(), &last = references.pictures.back();
  const std::vector<double> a = ColorsOf(picture.values, picture.channels);
  const std::vector<double> r = ColorsOf(first.values, first.channels);
  const std::vector<double> s = ColorsOf(last.values, last.channels);
  RelativeError error;
  if (a.size() != r.size() || r.size() != s.size()) return error;
  std::vector<double> errors;
  double reference = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double mean = (r[i] + s[i]) / 2, difference = (r[i] - s[i]) / 2;
    const double scale = 1 / (mean * mean + 0.01);
    errors.push_back((a[i] - r[i]) * (a[i] - s[i]) * scale);
    reference += difference * difference * scale;
  }
  std::sort(errors.begin(), errors.end());
  error.all = MeanOfFirst(errors, errors.size());
  error.trimmed =
      MeanOfFirst(errors, static_cast<size_t>(static_cast<double>(errors.size()) * (1 - kOutliers)));
  error.reference = reference / static_cast<double>(a.size());
  return error;
}

}  // namespace tessera
