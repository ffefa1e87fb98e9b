// More samples for a job that runs or is finished. What is there stays: the sums of finished frames are in
// the spool, as nodes of the same trees, and merge with what is rendered from now on.
#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/extension.h"
#include "coordinator/core/farm.h"

namespace tessera {
namespace {

uint32_t SamplesMax(const JobSpec& spec) {
  uint32_t samples = 0;
  for (const FrameOrder& frame : spec.frames) samples = std::max(samples, frame.spec.samples_per_pixel);
  return samples;
}

std::string SamplerOf(const FrameSpec& spec) {
  const auto attribute = spec.attributes.find(kSamplerAttribute);
  return attribute == spec.attributes.end() ? "its sampler"
                                            : fmt::format("sampler \"{}\"", attribute->second);
}

}  // namespace

bool Farm::MayKeep(const JobEntry& job) const {
  const auto& frames = job.spec->frames;
  return kept_sums_.keeps_any() && std::all_of(frames.begin(), frames.end(), IsExtendable);
}

void Farm::KeepSums(const JobEntry& job, uint32_t frame) {
  const FrameId id{job.id, frame};
  if (!MayKeep(job)) {
    output_.dropped.push_back(id);
    return;
  }
  for (const FrameId gone : kept_sums_.Add(id, SumsBytes(job.spec->frames[frame].spec))) {
    output_.dropped.push_back(gone);
  }
}

bool Farm::IsMovingSums(JobId id) const {
  const JobEntry* const job = FindJob(id);
  return job != nullptr && !(job->writing.empty() && job->loading.empty());
}

std::shared_ptr<const JobSpec> Farm::Spec(JobId id) const {
  const JobEntry* const job = FindJob(id);
  return job == nullptr ? nullptr : job->spec;
}

Result<void> Farm::CheckExtension(const JobEntry& job, uint32_t samples_per_pixel) const {
  const auto refuse = [&](const std::string& why) {
    return Failed(fmt::format("job {} cannot be extended: {}", Number(job.id), why));
  };
  for (const FrameOrder& frame : job.spec->frames) {
    if (IsExtendable(frame)) continue;
    if (frame.spec.IsAdaptive()) {
      return refuse(
          fmt::format("with --noise-threshold its pixels stop by themselves; submit the scene again "
                      "with --spp {} or a lower threshold",
                      samples_per_pixel));
    }
    return refuse(
        fmt::format("{} chooses its samples by how many there will be; submit the scene again with "
                    "--spp {}, or with Sampler \"sobol\", \"paddedsobol\" or \"independent\", whose "
                    "renders can be extended",
                    SamplerOf(frame.spec), samples_per_pixel));
  }
  if (HasEnded(job.state) && job.state != JobState::kFinished)
    return refuse(fmt::format("it was {}; submit the scene again", JobStateName(job.state)));
  if (samples_per_pixel < SamplesMax(*job.spec)) {
    return Error{ErrorKind::kBadInput,
                 fmt::format("job {} has {} samples per pixel already, and they only grow", Number(job.id),
                             SamplesMax(*job.spec))};
  }
  for (const auto& [frame, file] : job.files) {
    if (kept_sums_.Has({job.id, frame})) continue;
    return refuse(
        fmt::format("the sums of frame {} are not kept any more (tessera-coordinator --keep-sums); "
                    "submit the scene again with --spp {}",
                    frame, samples_per_pixel));
  }
  return {};
}

Result<JobStatus> Farm::Extend(Instant now, JobId id, uint32_t samples_per_pixel) {
  JobEntry* const job = FindJob(id);
  if (job == nullptr) return BadInput(fmt::format("there is no job {}", Number(id)));
  TESSERA_CHECK(!IsMovingSums(id));
  const bool is_done = IsExtendable(job->spec->frames.front()) && samples_per_pixel == SamplesMax(*job->spec);
  if (!is_done) {
    if (const auto checked = CheckExtension(*job, samples_per_pixel); !checked) return checked.error();
    ExtendFrames(*job, ExtendedSpec(*job->spec, samples_per_pixel));
    if (HasEnded(job->state)) {
      job->began = now - (job->ended - job->began);
      job->clock = {};  // what was rendered before is in the report before
      job->clock.begun = counters();
      job->state = JobState::kWaiting;
      open_jobs_.insert(id);
      scheduler_.AddJob(id, job->submitted, {}, job->spec, job->kept);
    } else {
      scheduler_.ExtendJob(id, job->spec, job->kept);
    }
    job->progress.clear();
    output_.facts.emplace_back(JobExtended{id, samples_per_pixel});
    output_.log.push_back(fmt::format("job_extended job={} samples_per_pixel={} samples={}", Number(id),
                                      samples_per_pixel, job->samples_total));
  }
  return StatusOf(now, *job);
}

void Farm::ExtendFrames(JobEntry& job, std::shared_ptr<const JobSpec> spec) {
  for (const auto& [frame, file] : job.files) {
    job.kept[frame] = job.spec->frames[frame].spec.samples_per_pixel;
    kept_sums_.Remove({job.id, frame});
  }
  job.files.clear();
  for (auto& [frame, merger] : job.mergers) {
    std::vector<TileNode> nodes = merger.TakeNodes();
    merger = Merger(spec->frames[frame].spec);
    for (TileNode& node : nodes) TESSERA_CHECK(merger.Add(std::move(node)).has_value());
  }
  job.spec = std::move(spec);
  job.samples_total = SamplesOf(*job.spec);
}

void Farm::SumsLoaded(Instant now, FrameId id, Result<std::vector<TileNode>> nodes) {
  JobEntry* const job = FindJob(id.job);
  if (job == nullptr || job->loading.erase(id.frame) == 0) return;
  const auto fail = [&](const std::string& why) {
    EndJob(
        now, *job, JobState::kFailed,
        fmt::format("the sums of frame {} cannot be read back: {}; submit the scene again", id.frame, why));
  };
  if (!nodes) return fail(nodes.error().message);
  Merger& merger = job->mergers.at(id.frame);
  for (TileNode& node : *nodes) {
    if (const auto added = merger.Add(std::move(node)); !added) return fail(added.error().message);
  }
  if (!scheduler_.IsComplete(id.job, id.frame)) return;
  if (!merger.Complete()) return fail("some are missing");
  CompleteFrame(*job, id.frame);
}

}  // namespace tessera
