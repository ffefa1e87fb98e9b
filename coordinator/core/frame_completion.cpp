#include "coordinator/core/frame_completion.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/extension.h"
#include "renderer/text/unicode.h"

namespace tessera {

Merger& FrameCompletion::MergerOf(Job& job, uint32_t frame) {
  const auto found = job.results.mergers.find(frame);
  if (found != job.results.mergers.end()) return found->second;
  if (job.in_spool.erase(frame) > 0) {
    job.results.loading.insert(frame);
    state_.output.facts.emplace_back(FrameResumed{job.id, frame});
    state_.output.loads.push_back({job.id, frame});
  }
  return job.results.mergers.try_emplace(frame, job.spec->frames[frame].spec).first->second;
}

void FrameCompletion::Complete(Job& job, uint32_t frame) {
  Merger& merger = job.results.mergers.at(frame);
  state_.output.pictures.push_back({job.id, frame, job.spec, merger.Snapshot()});
  job.results.frame_samples[frame] = merger.samples_merged();
  if (MayKeepSums(job)) state_.output.sums.push_back({{job.id, frame}, merger.TakeNodes()});
  job.results.mergers.erase(frame);
  job.results.writing.insert(frame);
}

void FrameCompletion::PictureWritten(Instant now, JobId id, uint32_t frame, const Digest& file) {
  Job* const job = state_.jobs.Find(id);
  if (job == nullptr) return;
  job->results.writing.erase(frame);
  if (HasEnded(job->state)) return;
  job->results.files[frame] = file;
  std::erase_if(job->results.votes, [&](const auto& each) { return each.first.frame == frame; });
  job->reason.clear();
  state_.output.facts.emplace_back(FrameFinished{id, frame, file, job->results.frame_samples.at(frame)});
  state_.output.log.push_back(
      fmt::format("frame_finished job={} frame={} file={}", Number(id), frame, file.Hex()));
  KeepSums(*job, frame);
  if (job->results.files.size() == job->spec->frames.size()) end_.End(now, *job, JobState::kFinished, "");
}

void FrameCompletion::PictureDelayed(JobId id, const std::string& reason) {
  Job* const job = state_.jobs.Find(id);
  if (job == nullptr || HasEnded(job->state)) return;
  if (job->reason != reason)
    state_.output.log.push_back(fmt::format("job_paused job={} reason={}", Number(id), LogText(reason)));
  job->reason = reason;
}

std::optional<FinishedPicture> FrameCompletion::Preview(JobId id, uint32_t frame) const {
  const Job* const job = state_.jobs.Find(id);
  if (job == nullptr || frame >= job->spec->frames.size() || HasEnded(job->state)) return std::nullopt;
  if (state_.scheduler.IsComplete(*job, frame)) return std::nullopt;
  const auto merger = job->results.mergers.find(frame);
  FrameSnapshot snapshot = merger == job->results.mergers.end()
                               ? FrameSnapshot(job->spec->frames[frame].spec, {})
                               : merger->second.Snapshot();
  return FinishedPicture{id, frame, job->spec, std::move(snapshot)};
}

std::optional<std::vector<TileNode>> FrameCompletion::Sums(FrameId id) const {
  const Job* const job = state_.jobs.Find(id.job);
  if (job == nullptr || job->results.loading.contains(id.frame)) return std::nullopt;
  const auto merger = job->results.mergers.find(id.frame);
  if (merger == job->results.mergers.end()) return std::nullopt;
  return merger->second.AllNodes();
}

void FrameCompletion::SumsLoaded(Instant now, FrameId id, Result<std::vector<TileNode>> nodes) {
  Job* const job = state_.jobs.Find(id.job);
  if (job == nullptr || job->results.loading.erase(id.frame) == 0) return;
  const auto fail = [&](const std::string& why) {
    end_.End(
        now, *job, JobState::kFailed,
        fmt::format("the sums of frame {} cannot be read back from the spool: {}; submit the scene again",
                    id.frame, why));
  };
  if (!nodes) return fail(nodes.error().message);
  Merger& merger = job->results.mergers.at(id.frame);
  for (TileNode& node : *nodes) {
    if (const auto added = merger.Add(std::move(node)); !added) return fail(added.error().message);
  }
  if (!state_.scheduler.IsComplete(*job, id.frame)) return;
  if (!merger.Complete()) return fail("some are missing");
  Complete(*job, id.frame);
}

bool FrameCompletion::MayKeepSums(const Job& job) const {
  const auto& frames = job.spec->frames;
  return state_.kept_sums.keeps_any() && std::all_of(frames.begin(), frames.end(), IsExtendable);
}

void FrameCompletion::KeepSums(const Job& job, uint32_t frame) {
  const FrameId id{job.id, frame};
  if (!MayKeepSums(job)) {
    state_.output.dropped.push_back(id);
    return;
  }
  for (const FrameId gone : state_.kept_sums.Add(id, SumsBytes(job.spec->frames[frame].spec)))
    state_.output.dropped.push_back(gone);
}

}  // namespace tessera
