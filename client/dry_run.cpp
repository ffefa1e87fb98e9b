#include "client/dry_run.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "client/in_process.h"

namespace tessera {
namespace {

double ElapsedSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

uint64_t PeakMemory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) << 10;
}

uint64_t SamplesOf(const FrameSpec& spec) {
  return static_cast<uint64_t>(spec.crop.area()) * spec.samples_per_pixel;
}

// Renders until `probe` is over and at least some samples are done, or everything is.
Result<double> MeasureSpeed(const Scene& scene, const FrameSpec& spec, int threads,
                            std::chrono::milliseconds probe, Cancellation& cancellation) {
  const auto start = std::chrono::steady_clock::now();
  std::stop_source enough;
  const std::stop_callback on_stop(cancellation.token(), [&enough] { enough.request_stop(); });
  double speed = 0;
  const auto picture =
      RenderInProcess(scene, spec, threads, enough.get_token(), [&](const Progress& progress) {
        if (progress.samples_done > 0) speed = progress.samples_per_second;
        if (speed > 0 && std::chrono::steady_clock::now() - start > probe) enough.request_stop();
      });
  if (cancellation.cancelled()) return cancellation.error();
  if (!picture && speed == 0) return picture.error();
  return speed;
}

}  // namespace

FarmCapacity CapacityFor(const std::string& coordinator, const std::set<std::string>& required_tags,
                         int priority, const std::vector<WorkerStatus>& workers,
                         const std::vector<JobStatus>& jobs) {
  FarmCapacity capacity{.coordinator = coordinator};
  for (const WorkerStatus& worker : workers) {
    if (worker.draining || worker.quarantined || !std::ranges::includes(worker.tags, required_tags)) continue;
    ++capacity.workers;
    capacity.threads += static_cast<uint64_t>(worker.slots);
  }
  capacity.jobs_ahead = static_cast<size_t>(std::ranges::count_if(jobs, [&](const JobStatus& job) {
    return !HasEnded(job.state) && job.state != JobState::kPaused && job.priority >= priority;
  }));
  return capacity;
}

std::optional<double> Forecast::farm_seconds() const {
  if (!farm || farm->threads == 0) return std::nullopt;
  const double speed = samples_per_second / threads * static_cast<double>(farm->threads);
  return load_s + static_cast<double>(samples) / speed;
}

namespace {

std::string Counted(uint64_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string FarmText(const Forecast& forecast) {
  if (!forecast.farm) return {};
  const FarmCapacity& farm = *forecast.farm;
  const auto seconds = forecast.farm_seconds();
  if (!seconds) return fmt::format("farm     no worker of {} may render it now\n", farm.coordinator);
  std::string text =
      fmt::format("farm     {}about {} on {} with {} of {}, if they are as fast as this machine",
                  forecast.is_adaptive ? "at most " : "", DurationText(*seconds),
                  Counted(farm.workers, "worker"), Counted(farm.threads, "thread"), farm.coordinator);
  if (farm.jobs_ahead > 0)
    text += fmt::format(" and were not shared with {} of the same or a higher priority",
                        Counted(farm.jobs_ahead, "open job"));
  return text + "\n";
}

}  // namespace

Result<Forecast> MakeForecast(const SceneOptions& options, int threads, std::chrono::milliseconds probe,
                              Cancellation& cancellation) {
  const auto start = std::chrono::steady_clock::now();
  const auto job = LoadSceneJob(options, Scene::Depth::kRender, cancellation.token());
  if (!job) return job.error();
  const FrameSpec& first = job->packed.frames.front().spec;
  Forecast forecast;
  forecast.load_s = ElapsedSince(start);
  forecast.frames = job->packed.frames.size();
  forecast.width = first.width;
  forecast.height = first.height;
  forecast.samples_per_pixel = first.samples_per_pixel;
  forecast.is_adaptive = first.IsAdaptive();
  for (const FrameRequest& frame : job->packed.frames) forecast.samples += SamplesOf(frame.spec);
  forecast.files = job->packed.package.files.size();
  for (const auto& [path, file] : job->packed.package.files) forecast.file_bytes += file.size;
  forecast.threads = threads;
  // The scene's own frame: what is added for farms is not needed here.
  const auto speed = MeasureSpeed(*job->scene, job->scene->frame(), threads, probe, cancellation);
  if (!speed) return speed.error();
  forecast.samples_per_second = *speed;
  forecast.memory_bytes = PeakMemory();
  return forecast;
}

std::string ForecastText(const Forecast& forecast) {
  const char* const at_most = forecast.is_adaptive ? "at most " : "";
  return fmt::format(
             "frames   {} of {} x {} pixels, {}{} samples per pixel\n"
             "files    {}, {}\n"
             "memory   {} to load and render it\n"
             "time     {}about {} on this machine with {} thread{} ({:.0f} samples/s)\n",
             forecast.frames, forecast.width, forecast.height, at_most, forecast.samples_per_pixel,
             forecast.files, BytesText(forecast.file_bytes), BytesText(forecast.memory_bytes), at_most,
             DurationText(forecast.seconds()), forecast.threads, forecast.threads == 1 ? "" : "s",
             forecast.samples_per_second) +
         FarmText(forecast);
}

std::string ForecastJson(const Forecast& forecast) {
  nlohmann::ordered_json json;
  json["frames"] = forecast.frames;
  json["width"] = forecast.width;
  json["height"] = forecast.height;
  json["samples_per_pixel"] = forecast.samples_per_pixel;
  json["adaptive"] = forecast.is_adaptive;
  json["samples"] = forecast.samples;
  json["files"] = forecast.files;
  json["file_bytes"] = forecast.file_bytes;
  json["memory_bytes"] = forecast.memory_bytes;
  json["threads"] = forecast.threads;
  json["samples_per_second"] = forecast.samples_per_second;
  json["seconds"] = forecast.seconds();
  if (forecast.farm) {
    const auto seconds = forecast.farm_seconds();
    nlohmann::ordered_json farm;
    farm["coordinator"] = forecast.farm->coordinator;
    farm["workers"] = forecast.farm->workers;
    farm["threads"] = forecast.farm->threads;
    farm["jobs_ahead"] = forecast.farm->jobs_ahead;
    farm["seconds"] = nullptr;
    if (seconds) farm["seconds"] = *seconds;
    json["farm"] = std::move(farm);
  }
  return json.dump() + "\n";
}

}  // namespace tessera
