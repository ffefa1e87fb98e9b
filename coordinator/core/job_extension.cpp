#include "coordinator/core/job_extension.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/extension.h"
#include "coordinator/core/job_report.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

uint32_t SamplesMax(const JobSpec& spec) {
  uint32_t samples = 0;
  for (const FrameRequest& frame : spec.frames) samples = std::max(samples, frame.spec.samples_per_pixel);
  return samples;
}

std::string SamplerOf(const FrameSpec& spec) {
  const auto attribute = spec.attributes.find(kSamplerAttribute);
  return attribute == spec.attributes.end() ? "its sampler"
                                            : fmt::format("sampler \"{}\"", attribute->second);
}

// Why the frame itself cannot get more samples.
std::string WhyNotExtendable(const FrameRequest& frame, uint32_t samples_per_pixel) {
  if (frame.spec.IsAdaptive()) {
    return fmt::format(
        "its pixels stop adaptively (--noise-threshold); submit the scene again with --spp {} "
        "or a lower threshold",
        samples_per_pixel);
  }
  return fmt::format(
      "the samples of {} depend on their total number; submit the scene again with --spp {}, or with "
      "Sampler \"sobol\", \"paddedsobol\" or \"independent\", whose renders can be extended",
      SamplerOf(frame.spec), samples_per_pixel);
}

}  // namespace

Result<void> JobExtension::Check(const Job& job, uint32_t samples_per_pixel) const {
  const auto refuse = [&](const std::string& why) {
    return Failed(fmt::format("job {} cannot be extended: {}", Number(job.id), why));
  };
  for (const FrameRequest& frame : job.spec->frames) {
    if (!IsExtendable(frame)) return refuse(WhyNotExtendable(frame, samples_per_pixel));
  }
  if (HasEnded(job.state) && job.state != JobState::kFinished)
    return refuse(fmt::format("it was {}; submit the scene again", JobStateName(job.state)));
  if (!job.results.failed.empty()) {
    return refuse(fmt::format("frame {} of it failed; submit the scene again",
                              job.spec->frames[job.results.failed.begin()->first].number));
  }
  if (samples_per_pixel < SamplesMax(*job.spec)) {
    return BadInput(fmt::format("job {} has {} samples per pixel already; choose a larger --spp",
                                Number(job.id), SamplesMax(*job.spec)));
  }
  for (const auto& [frame, file] : job.results.files) {
    if (state_.kept_sums.Has({job.id, frame})) continue;
    return refuse(fmt::format(
        "the sums of frame {} are no longer kept (tessera-coordinator --sums-size); submit the scene "
        "again with --spp {}",
        frame, samples_per_pixel));
  }
  return {};
}

Result<void> JobExtension::Extend(Instant now, Job& job, uint32_t samples_per_pixel) {
  if (IsExtendable(job.spec->frames.front()) && samples_per_pixel == SamplesMax(*job.spec)) return {};
  if (const auto checked = Check(job, samples_per_pixel); !checked) return checked;
  auto spec = ExtendedSpec(*job.spec, samples_per_pixel);
  ExtendFrames(job, *spec);
  if (HasEnded(job.state)) {
    job.began = now - (job.ended - job.began);
    job.former_times.reset();
    job.clock = {};  // what was rendered before is in the report before
    job.clock.begun = state_.scheduler.counters();
    job.state = JobState::kWaiting;
    job.spec = std::move(spec);
    state_.jobs.MarkOpen(job.id);
    state_.scheduler.AddJob(job);
  } else {
    state_.scheduler.ExtendJob(job, std::move(spec));
  }
  state_.output.facts.emplace_back(JobExtended{job.id, samples_per_pixel});
  state_.output.facts.emplace_back(TimedOf(state_, job));
  state_.output.log.push_back(fmt::format("job_extended job={} samples_per_pixel={} samples={}",
                                          Number(job.id), samples_per_pixel, job.results.samples_total));
  return {};
}

// Finished frames are open again and have their sums in the spool alone; mergers get the larger frame.
void JobExtension::ExtendFrames(Job& job, const JobSpec& spec) {
  for (const auto& [frame, file] : job.results.files) {
    job.in_spool[frame] = job.spec->frames[frame].spec.samples_per_pixel;
    state_.kept_sums.Remove({job.id, frame});
  }
  job.results.files.clear();
  job.results.lost.clear();
  for (auto& [frame, merger] : job.results.mergers) {
    std::vector<TileNode> nodes = merger.TakeNodes();
    merger = Merger(spec.frames[frame].spec);
    for (TileNode& node : nodes) TESSERA_CHECK(merger.Add(std::move(node)).has_value());
  }
  job.results.progress.clear();
  job.results.samples_total = SamplesOf(spec);
}

void JobExtension::Restore(Job& job, uint32_t samples_per_pixel) {
  for (const auto& [frame, file] : job.results.files)
    job.in_spool[frame] = job.spec->frames[frame].spec.samples_per_pixel;
  job.results.files.clear();
  job.spec = ExtendedSpec(*job.spec, samples_per_pixel);
  job.results.samples_total = SamplesOf(*job.spec);
  job.state = JobState::kWaiting;
  state_.jobs.MarkOpen(job.id);
}

}  // namespace tessera
