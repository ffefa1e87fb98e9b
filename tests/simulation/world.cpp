#include "tests/simulation/world.h"

#include <fmt/format.h>

#include <algorithm>

namespace tessera {

World::World(uint64_t seed, SimulationOptions simulation_options, OnTrace on_trace)
    : options(std::move(simulation_options)), random(Hash(seed, 1)), on_trace_(std::move(on_trace)) {}

void World::Trace(const std::string& line) {
  const std::string timed = fmt::format("{:.6f} {}\n", Seconds(queue.now()), line);
  trace_.Add(timed);
  if (on_trace_) on_trace_(timed);
}

void World::Violation(const std::string& what) {
  Trace("VIOLATION " + what);
  report.violations.push_back(fmt::format("{:.6f}: {}", Seconds(queue.now()), what));
}

void World::Send(Deliver deliver) {
  const bool healthy = is_healthy();
  if (!healthy && random.Chance(options.loss)) return;
  const double delay_max_s = healthy ? 0.002 : options.delay_max_s;
  if (!healthy && random.Chance(options.duplication))
    queue.After(random.Duration(0, delay_max_s * 4), deliver);
  const bool is_late = !healthy && random.Chance(options.reordering);
  queue.After(random.Duration(0, is_late ? 5 : delay_max_s), std::move(deliver));
}

JobModel* World::ModelOf(JobId id) {
  const auto found = std::ranges::find_if(
      jobs, [&](const JobModel& job) { return job.id == id && job.directory == directory; });
  return found == jobs.end() ? nullptr : &*found;
}

World::FrameModel World::FrameOf(const Digest& scene) const {
  for (const JobModel& job : jobs) {
    const auto found = std::ranges::find(job.scenes, scene);
    if (found != job.scenes.end()) return {&job, static_cast<uint32_t>(found - job.scenes.begin())};
  }
  return {};
}

SimulationReport World::TakeReport() {
  report.ended_s = Seconds(queue.now());
  report.trace = trace_.Finish();
  return std::move(report);
}

}  // namespace tessera
