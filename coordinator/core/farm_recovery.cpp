// From facts and spool of former processes to the farm as it was, and back to facts.
#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/extension.h"
#include "coordinator/core/farm.h"

namespace tessera {

void Farm::Restore(const Fact& fact) {
  if (const auto* submitted = std::get_if<JobSubmitted>(&fact)) {
    AddJob(submitted->job, submitted->spec);
  } else if (const auto* finished = std::get_if<FrameFinished>(&fact)) {
    JobEntry* const job = FindJob(finished->job);
    if (job == nullptr || finished->frame >= job->spec->frames.size()) return;
    job->files[finished->frame] = finished->file;
    job->taken[finished->frame] = finished->samples;
    job->kept.erase(finished->frame);
    std::erase_if(job->opinions, [&](const auto& each) { return each.first.frame == finished->frame; });
    finished_.push_back({finished->job, finished->frame});
  } else if (const auto* ended = std::get_if<JobEnded>(&fact)) {
    JobEntry* const job = FindJob(ended->job);
    if (job == nullptr) return;
    job->state = ended->state;
    job->reason = ended->reason;
    job->opinions.clear();
    open_jobs_.erase(ended->job);
  } else if (const auto* extended = std::get_if<JobExtended>(&fact)) {
    if (JobEntry* const job = FindJob(extended->job)) RestoreExtension(*job, extended->samples_per_pixel);
  } else if (const auto* resumed = std::get_if<FrameResumed>(&fact)) {
    if (JobEntry* const job = FindJob(resumed->job)) job->kept.erase(resumed->frame);
  } else if (const auto* forgotten = std::get_if<JobsForgotten>(&fact)) {
    job_next_ = std::max(job_next_, Number(forgotten->last) + 1);
  } else {
    RestoreControl(fact);
  }
}

void Farm::RestoreExtension(JobEntry& job, uint32_t samples_per_pixel) {
  for (const auto& [frame, file] : job.files) {
    job.kept[frame] = job.spec->frames[frame].spec.samples_per_pixel;
  }
  job.files.clear();
  job.spec = ExtendedSpec(*job.spec, samples_per_pixel);
  job.samples_total = SamplesOf(*job.spec);
  job.state = JobState::kWaiting;
  open_jobs_.insert(job.id);
}

Farm::SpoolUse Farm::FoundInSpool(FrameId id, bool begun) {
  JobEntry* const job = FindJob(id.job);
  if (job == nullptr || id.frame >= job->spec->frames.size()) return SpoolUse::kDrop;
  const bool is_finished = job->files.contains(id.frame);
  if (HasEnded(job->state) && job->state != JobState::kFinished) return SpoolUse::kDrop;
  if (is_finished && !MayKeep(*job)) return SpoolUse::kDrop;
  if (is_finished || (job->kept.contains(id.frame) && !begun)) {
    found_kept_.insert(id);
    return SpoolUse::kKeep;
  }
  job->kept.erase(id.frame);
  return SpoolUse::kRestore;
}

void Farm::RestoreNode(FrameId id, TileNode node) {
  JobEntry& job = jobs_.at(id.job);
  Merger& merger = job.mergers.try_emplace(id.frame, job.spec->frames[id.frame].spec).first->second;
  const auto added = merger.Add(std::move(node));
  if (added) return;
  output_.log.push_back(fmt::format("result_ignored job={} frame={} reason=\"{}\"", Number(id.job), id.frame,
                                    added.error().message));
}

// Frames that were finished and have their sums in the spool, in the order they were finished.
void Farm::RestoreKept() {
  for (const FrameId id : finished_) {
    const JobEntry& job = jobs_.at(id.job);
    if (!found_kept_.contains(id) || !job.files.contains(id.frame)) continue;
    KeepSums(job, id.frame);
  }
  finished_.clear();
  for (auto& [id, job] : jobs_) {
    std::erase_if(job.kept, [&, job_id = id](const auto& each) {
      return !found_kept_.contains({job_id, each.first});
    });
  }
  found_kept_.clear();
}

void Farm::Begin(Instant now) {
  RestoreKept();
  for (const WorkerBarred& bar : std::exchange(former_bars_, {})) {
    scheduler_.RestoreBar(now, {bar.worker, bar.name, bar.drained, bar.quarantine});
  }
  for (auto& [id, job] : jobs_) {
    for (const auto& [frame, file] : job.files) {
      job.samples_done += job.taken.at(frame);
      job.samples_total -= SamplesOf(job.spec->frames[frame].spec) - job.taken.at(frame);
    }
  }
  for (const JobId id : std::set<JobId>(open_jobs_)) ResumeJob(now, jobs_.at(id));
  ForgetEnded();
}

void Farm::ResumeJob(Instant now, JobEntry& job) {
  job.began = now;
  job.clock.begun = counters();
  std::set<uint32_t> finished;
  for (const auto& [frame, file] : job.files) finished.insert(frame);
  scheduler_.AddJob(job.id, job.submitted, finished, job.spec, job.kept);
  uint64_t restored = 0;
  for (const auto& [frame, samples] : job.kept) {
    restored += static_cast<uint64_t>(job.spec->frames[frame].spec.crop.area()) * samples;
  }
  std::vector<uint32_t> complete;
  for (const auto& [frame, merger] : job.mergers) {
    restored += merger.samples_merged();
    job.samples_total -= SamplesOf(merger.spec()) - merger.samples_total();
    RestoreWork(job.id, frame, merger);
    if (merger.Complete()) complete.push_back(frame);
  }
  scheduler_.SetPriority(job.id, job.priority);
  scheduler_.SetPaused(now, job.id, job.paused);
  for (const auto& [unit, opinions] : job.opinions) {
    for (const Opinion& opinion : opinions) scheduler_.RestoreOpinion(unit, opinion);
  }
  job.samples_done += restored;
  output_.log.push_back(fmt::format("job_resumed job={} frames_finished={} samples_restored={}",
                                    Number(job.id), finished.size(), restored));
  for (const uint32_t frame : complete) CompleteFrame(job, frame);
  if (finished.size() == job.spec->frames.size()) EndJob(now, job, JobState::kFinished, "");
}

// The scheduler learns what is merged, and which tiles have decided by it to stop.
void Farm::RestoreWork(JobId id, uint32_t frame, const Merger& merger) {
  merger.VisitNodes([&](uint32_t tile, SampleRange range, const SharedSums&) {
    scheduler_.RestoreDone(id, frame, {tile, range});
  });
  if (!merger.spec().IsAdaptive()) return;
  for (int tile = 0; tile < merger.spec().TileCount(); ++tile) {
    scheduler_.SetGoal(id, frame, static_cast<uint32_t>(tile), merger.Goal(tile));
  }
}

// A job as it was submitted, then what it was extended to, with the frames that were finished before.
void Farm::AppendHistory(const JobEntry& job, std::vector<Fact>& facts) const {
  facts.emplace_back(JobSubmitted{job.id, job.submitted});
  if (job.spec == job.submitted) return;
  std::set<uint32_t> steps;
  for (const auto& [frame, samples] : job.kept) steps.insert(samples);
  for (const uint32_t samples : steps) {
    facts.emplace_back(JobExtended{job.id, samples});
    for (const auto& [frame, kept] : job.kept) {
      if (kept == samples) facts.emplace_back(FrameFinished{job.id, frame, {}, job.taken.at(frame)});
    }
  }
  uint32_t samples_max = 0;
  for (const FrameOrder& frame : job.spec->frames) {
    samples_max = std::max(samples_max, frame.spec.samples_per_pixel);
  }
  facts.emplace_back(JobExtended{job.id, samples_max});
}

std::vector<Fact> Farm::Snapshot() const {
  std::vector<Fact> facts{CoordinatorStarted{epoch_}, JobsForgotten{JobId{job_next_ - 1}}};
  for (const auto& [id, job] : jobs_) AppendHistory(job, facts);
  for (const auto& [id, job] : jobs_) {
    for (const auto& [frame, file] : job.files) {
      if (!kept_sums_.Has({id, frame}))
        facts.emplace_back(FrameFinished{id, frame, file, job.taken.at(frame)});
    }
  }
  for (const FrameId frame : kept_sums_.Frames()) {
    const JobEntry& job = jobs_.at(frame.job);
    facts.emplace_back(
        FrameFinished{frame.job, frame.frame, job.files.at(frame.frame), job.taken.at(frame.frame)});
  }
  for (const auto& [id, job] : jobs_) {
    AppendControl(job, facts);
    if (HasEnded(job.state)) facts.emplace_back(JobEnded{id, job.state, job.reason});
  }
  for (const Scheduler::Bar& bar : scheduler_.Bars()) facts.emplace_back(FactOf(bar));
  return facts;
}

}  // namespace tessera
