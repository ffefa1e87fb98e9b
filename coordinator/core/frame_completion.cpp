#include "coordinator/core/frame_completion.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/extension.h"
#include "coordinator/core/schedule/policy.h"
#include "renderer/film/adaptive.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

std::string UnreadableSums(uint32_t frame, const std::string& why) {
  return fmt::format("the sums of frame {} cannot be read back from the spool: {}; submit the scene again",
                     frame, why);
}

// Whether the first samples of all pixels are merged.
bool HasFirst(const Merger& merger, uint32_t samples) {
  const std::vector<SampleRange> ranges = UnitPartition(merger.spec(), samples);
  for (int tile = 0; tile < merger.spec().TileCount(); ++tile) {
    const auto has = [&](SampleRange range) { return merger.Has(tile, range); };
    if (!std::ranges::all_of(ranges, has)) return false;
  }
  return true;
}

}  // namespace

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
  const FrameId id{job.id, frame};
  Merger& merger = job.results.mergers.at(frame);
  const uint64_t bytes = SumsBytes(merger.spec());
  if (pictures_.Hold(id, bytes)) {
    state_.output.pictures.push_back({job.id, frame, job.spec, merger.Snapshot()});
  } else {
    pictures_.Wait(id, bytes, Instant{0});
  }
  job.results.frame_samples[frame] = merger.samples_merged();
  if (const auto noise = merger.noise()) job.results.noise.Set(frame, *noise);
  if (MayKeepSums()) state_.output.sums.push_back({id, merger.TakeNodes()});
  job.results.mergers.erase(frame);
  job.results.writing.insert(frame);
}

void FrameCompletion::PictureWritten(Instant now, FrameId id, const PictureFile& file) {
  pictures_.Release(id);
  Job* const job = state_.jobs.Find(id.job);
  if (job == nullptr) return;
  job->results.unwritten.erase(id.frame);
  if (job->results.remaking.contains(id.frame)) return Remade(*job, id.frame, file);
  if (job->results.writing.erase(id.frame) == 0 || HasEnded(job->state)) return;
  job->results.files[id.frame] = file;
  state_.output.facts.emplace_back(
      FrameFinished{id.job, id.frame, file, job->results.frame_samples.at(id.frame)});
  Log(fmt::format("frame_finished job={} frame={} file={}", Number(id.job), id.frame, file.digest.Hex()));
  KeepSums(*job, id.frame);
  end_.EndIfDecided(now, *job);
}

void FrameCompletion::PictureDelayed(Instant now, FrameId id, const std::string& reason) {
  pictures_.Release(id);
  Job* const job = state_.jobs.Find(id.job);
  if (job == nullptr) return;
  JobResults& results = job->results;
  // What was rendered of a job that has ended is kept if that is possible.
  if (HasEnded(job->state)) results.writing.erase(id.frame);
  if (!results.writing.contains(id.frame) && !results.remaking.contains(id.frame)) return;
  const std::string text = fmt::format("the picture of frame {} cannot be written: {}",
                                       job->spec->frames[id.frame].number, reason);
  if (results.unwritten[id.frame] != text) {
    Log(fmt::format("picture_delayed job={} frame={} reason={}", Number(id.job), id.frame, LogText(reason)));
    results.unwritten[id.frame] = text;
    state_.AddMessage(MessageLevel::kWarning, id.job, text);
  }
  pictures_.Wait(id, SumsBytes(job->spec->frames[id.frame].spec), now + kPictureRetry);
}

void FrameCompletion::PictureNotDenoised(FrameId id, const std::string& reason) {
  const Job* const job = state_.jobs.Find(id.job);
  if (job == nullptr) return;
  Log(fmt::format("denoise_failed job={} frame={} reason={}", Number(id.job), id.frame, LogText(reason)));
  state_.AddMessage(MessageLevel::kWarning, id.job,
                    fmt::format("frame {} could not be denoised and its picture is noisy: {}",
                                job->spec->frames[id.frame].number, reason));
}

bool FrameCompletion::PictureDamaged(FrameId id, const std::string& reason) {
  Job* const job = state_.jobs.Find(id.job);
  if (job == nullptr || !job->results.files.contains(id.frame)) return false;
  if (job->results.remaking.contains(id.frame)) return true;
  if (!state_.kept_sums.Has(id)) {
    Lose(*job, id.frame, reason);
    return false;
  }
  Log(fmt::format("picture_damaged job={} frame={} reason={}", Number(id.job), id.frame, LogText(reason)));
  state_.AddMessage(
      MessageLevel::kWarning, id.job,
      fmt::format("the picture of frame {} is made again: {}", job->spec->frames[id.frame].number, reason));
  job->results.remaking.insert(id.frame);
  pictures_.Wait(id, SumsBytes(job->spec->frames[id.frame].spec), Instant{0});
  return true;
}

void FrameCompletion::PictureIntact(FrameId id) {
  if (Job* const job = state_.jobs.Find(id.job)) job->results.lost.erase(id.frame);
}

// The file usually has its former bytes. Another release of the library that encodes it may choose others.
void FrameCompletion::Remade(Job& job, uint32_t frame, const PictureFile& file) {
  job.results.remaking.erase(frame);
  job.results.lost.erase(frame);
  PictureFile& known = job.results.files.at(frame);
  Log(fmt::format("picture_remade job={} frame={} file={} is_same={}", Number(job.id), frame,
                  file.digest.Hex(), known.digest == file.digest));
  if (known == file) return;
  known = file;
  state_.output.facts.emplace_back(FrameFinished{job.id, frame, file, job.results.frame_samples.at(frame)});
}

void FrameCompletion::Lose(Job& job, uint32_t frame, const std::string& reason) {
  job.results.remaking.erase(frame);
  job.results.unwritten.erase(frame);
  const std::string text =
      fmt::format("the picture of frame {} is lost ({}) and its sums are gone; submit the scene again",
                  job.spec->frames[frame].number, reason);
  std::string& known = job.results.lost[frame];
  if (known == text) return;
  known = text;
  state_.AddMessage(MessageLevel::kError, job.id, text);
  Log(fmt::format("picture_lost job={} frame={} reason={}", Number(job.id), frame, LogText(reason)));
}

void FrameCompletion::Advance(Instant now) {
  while (const auto id = pictures_.TakeDue(now)) {
    const Job* const job = state_.jobs.Find(id->job);
    const bool is_wanted = job != nullptr && (job->results.writing.contains(id->frame) ||
                                              job->results.remaking.contains(id->frame));
    if (is_wanted) {
      state_.output.loads.push_back(*id);
    } else {
      pictures_.Release(*id);
    }
  }
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
  if (job != nullptr && job->results.loading.erase(id.frame) > 0)
    return ContinueFrame(now, *job, id.frame, std::move(nodes));
  const bool is_wanted =
      job != nullptr && (job->results.writing.contains(id.frame) || job->results.remaking.contains(id.frame));
  if (!is_wanted) return pictures_.Release(id);
  MakePicture(now, *job, id.frame, std::move(nodes));
}

// Adds the sums of an extended frame to what was merged of it since.
void FrameCompletion::ContinueFrame(Instant now, Job& job, uint32_t frame,
                                    Result<std::vector<TileNode>> nodes) {
  const auto fail = [&](const std::string& why) {
    end_.End(now, job, JobState::kFailed, UnreadableSums(frame, why));
  };
  if (!nodes) return fail(nodes.error().message);
  Merger& merger = job.results.mergers.at(frame);
  for (TileNode& node : *nodes) {
    if (const auto added = merger.Add(std::move(node)); !added) return fail(added.error().message);
  }
  // The scheduler does not lease what the frame was finished with. Adaptive frames are not extended, so these
  // are the same samples of each pixel.
  const uint64_t before =
      job.results.frame_samples.at(frame) / static_cast<uint64_t>(merger.spec().crop.area());
  if (!HasFirst(merger, static_cast<uint32_t>(before))) return fail("some are missing");
  if (!state_.scheduler.IsComplete(job, frame)) return;
  if (!merger.Complete()) return fail("some are missing");
  Complete(job, frame);
}

// Makes the picture of a complete frame from all its sums.
void FrameCompletion::MakePicture(Instant now, Job& job, uint32_t frame,
                                  Result<std::vector<TileNode>> nodes) {
  const auto fail = [&](const std::string& why) {
    pictures_.Release({job.id, frame});
    if (job.results.remaking.contains(frame)) return Lose(job, frame, why);
    end_.End(now, job, JobState::kFailed, UnreadableSums(frame, why));
  };
  if (!nodes) return fail(nodes.error().message);
  Merger merger(job.spec->frames[frame].spec);
  for (TileNode& node : *nodes) {
    if (const auto added = merger.Add(std::move(node)); !added) return fail(added.error().message);
  }
  if (!merger.Complete()) return fail("some sums are missing");
  state_.output.pictures.push_back({job.id, frame, job.spec, merger.Snapshot()});
}

void FrameCompletion::KeepSums(const Job& job, uint32_t frame) {
  const FrameId id{job.id, frame};
  if (!MayKeepSums()) {
    state_.output.dropped.push_back(id);
    return;
  }
  for (const FrameId gone : state_.kept_sums.Add(id, SumsBytes(job.spec->frames[frame].spec)))
    state_.output.dropped.push_back(gone);
}

}  // namespace tessera
