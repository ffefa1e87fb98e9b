#include "coordinator/core/farm_recovery.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/extension.h"
#include "coordinator/core/job_report.h"
#include "coordinator/core/result_acceptance.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// Calls one of several functions, the one that takes the value.
template <typename... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

}  // namespace

WorkerQuarantined FactOf(const WorkerBlock& block) {
  return {block.worker, block.name, block.is_drained, block.quarantine};
}

void FarmRecovery::Restore(const Fact& fact) {
  const auto with_job = [&](JobId id, const auto& action) {
    if (Job* const job = state_.jobs.Find(id)) action(*job);
  };
  std::visit(
      Overloaded{
          [](const CoordinatorStarted&) {},
          [&](const JobOwned& each) { owners_[each.job] = each.owner; },
          [&](const JobTimed& each) { times_.insert_or_assign(each.job, each); },
          [&](const JobOrdered& each) {
            const auto owner = owners_.extract(each.job);
            state_.jobs.Add(each.job, each.order).owner = owner ? owner.mapped() : JobOwner{};
          },
          [&](const JobSubmitted& each) {
            if (Job* const job = state_.jobs.Find(each.job); job != nullptr && job->order != nullptr)
              return state_.jobs.SetFrames(*job, each.spec);
            const auto owner = owners_.extract(each.job);
            state_.jobs.Add(each.job, each.spec).owner = owner ? owner.mapped() : JobOwner{};
          },
          [&](const FrameFinished& each) { with_job(each.job, [&](Job& job) { RestoreFrame(job, each); }); },
          [&](const FrameFailed& each) { with_job(each.job, [&](Job& job) { RestoreFrame(job, each); }); },
          [&](const JobEnded& each) {
            with_job(each.job, [&](Job& job) {
              job.state = each.state;
              job.reason = each.reason;
              votes_.erase(each.job);
              state_.jobs.MarkEnded(each.job);
            });
          },
          [&](const JobExtended& each) {
            with_job(each.job, [&](Job& job) { extension_.Restore(job, each.samples_per_pixel); });
          },
          [&](const FrameResumed& each) {
            with_job(each.job, [&](Job& job) { job.in_spool.erase(each.frame); });
          },
          [&](const JobsForgotten& each) { state_.jobs.ReserveIds(each.last); },
          [&](const JobPaused& each) { with_job(each.job, [&](Job& job) { job.is_paused = each.paused; }); },
          [&](const JobPriorityChanged& each) {
            with_job(each.job, [&](Job& job) { job.priority = each.priority; });
          },
          [&](const WorkerQuarantined& each) {
            blocks_.push_back({each.worker, each.name, each.drained, each.quarantine});
          },
          [&](const VoteRecorded& each) {
            with_job(each.unit.job, [&](Job& job) { RestoreVote(job, each); });
          },
          [&](const UnitsCounted& each) {
            with_job(each.job, [&](Job& job) {
              job.results.units_verified = each.verified;
              job.results.units_disputed = each.disputed;
              job.results.units_suspect = each.suspect;
            });
          },
          [&](const auto& of_members) { state_.membership.Restore(of_members); },
      },
      fact);
}

void FarmRecovery::RestoreFrame(Job& job, const FrameFinished& fact) {
  if (fact.frame >= job.spec->frames.size()) return;
  job.results.files[fact.frame] = fact.file;
  job.results.frame_samples[fact.frame] = fact.samples;
  finished_.push_back({fact.job, fact.frame});
  EndFrame(job, fact.frame);
}

void FarmRecovery::RestoreFrame(Job& job, const FrameFailed& fact) {
  if (fact.frame >= job.spec->frames.size()) return;
  job.results.failed[fact.frame] = fact.reason;
  EndFrame(job, fact.frame);
}

void FarmRecovery::EndFrame(Job& job, uint32_t frame) {
  job.in_spool.erase(frame);
  std::erase_if(votes_[job.id], [&](const auto& vote) { return vote.first.frame == frame; });
}

// Counts the vote as it was counted when it was cast.
void FarmRecovery::RestoreVote(Job& job, const VoteRecorded& fact) {
  WorkUnit unit = fact.unit;
  if (unit.frame >= job.spec->frames.size()) return;
  unit.scene = job.SceneOf(unit.frame);
  Votes& votes = votes_[job.id];
  std::vector<Vote>& of_unit = votes[unit];
  const bool is_decided =
      std::ranges::any_of(of_unit, [&](const Vote& each) { return each.result == fact.result; });
  if (is_decided) {
    ++job.results.units_verified;
    votes.erase(unit);
    return;
  }
  if (of_unit.size() == 1) ++job.results.units_disputed;
  of_unit.push_back({fact.worker, fact.name, fact.result, fact.machine});
}

SpoolUse FarmRecovery::FoundInSpool(FrameId id, bool begun) {
  Job* const job = state_.jobs.Find(id.job);
  if (job == nullptr || id.frame >= job->spec->frames.size()) return SpoolUse::kDrop;
  const bool is_finished = job->results.files.contains(id.frame);
  if (HasEnded(job->state) && job->state != JobState::kFinished) return SpoolUse::kDrop;
  if (job->results.failed.contains(id.frame)) return SpoolUse::kDrop;
  if (is_finished && !frames_.MayKeepSums()) return SpoolUse::kDrop;
  if (is_finished || (job->in_spool.contains(id.frame) && !begun)) {
    found_kept_.insert(id);
    return SpoolUse::kKeep;
  }
  job->in_spool.erase(id.frame);
  return SpoolUse::kRestore;
}

void FarmRecovery::RestoreNode(FrameId id, TileNode node) {
  Job& job = state_.jobs.At(id.job);
  Merger& merger = job.results.mergers.try_emplace(id.frame, job.spec->frames[id.frame].spec).first->second;
  const auto added = merger.Add(std::move(node));
  if (added) return;
  state_.output.log.push_back(fmt::format("result_ignored job={} frame={} reason={}", Number(id.job),
                                          id.frame, LogText(added.error().message)));
}

// Frames that were finished and have their sums in the spool, in the order they were finished.
void FarmRecovery::RestoreKeptSums() {
  for (const FrameId id : std::exchange(finished_, {})) {
    const Job& job = state_.jobs.At(id.job);
    if (found_kept_.contains(id) && job.results.files.contains(id.frame)) frames_.KeepSums(job, id.frame);
  }
  for (auto& [id, job] : state_.jobs.all()) {
    std::erase_if(job.in_spool, [&, job_id = id](const auto& each) {
      return !found_kept_.contains({job_id, each.first});
    });
  }
  found_kept_.clear();
}

void FarmRecovery::RestoreCounts(Job& job) {
  JobResults& results = job.results;
  for (const auto& [frame, file] : results.files) {
    results.samples_done += results.frame_samples.at(frame);
    results.samples_total -= SamplesOf(job.spec->frames[frame].spec) - results.frame_samples.at(frame);
  }
  for (const auto& [frame, reason] : results.failed)
    results.samples_total -= SamplesOf(job.spec->frames[frame].spec);
}

// A clock that was set back makes no job begin in the future or end before it began.
void FarmRecovery::RestoreTimes(Instant now, Job& job) const {
  const auto timed = times_.find(job.id);
  if (timed == times_.end()) {
    job.began = job.ended = now;
    return;
  }
  const auto& [id, began_ms, ended_ms, times] = timed->second;
  const auto since = [&](int64_t at_ms, int64_t until_ms) {
    return std::chrono::milliseconds(std::max<int64_t>(0, until_ms - at_ms));
  };
  job.began = now - since(began_ms, state_.UnixTime_ms(now));
  job.ended = job.began;
  if (!HasEnded(job.state) || !ended_ms) return;
  job.ended += since(began_ms, *ended_ms);
  job.former_times = times;
}

void FarmRecovery::Begin(Instant now) {
  RestoreKeptSums();
  for (const WorkerBlock& block : std::exchange(blocks_, {})) state_.scheduler.RestoreBlock(now, block);
  for (auto& [id, job] : state_.jobs.all()) {
    RestoreCounts(job);
    RestoreTimes(now, job);
  }
  for (const JobId id : std::set<JobId>(state_.jobs.open())) Resume(now, state_.jobs.At(id));
  votes_.clear();
  owners_.clear();
  times_.clear();
  end_.ForgetOldest();
}

void FarmRecovery::Resume(Instant now, Job& job) {
  job.clock.begun = state_.scheduler.counters();
  if (job.order != nullptr) return;  // Preparations
  std::set<uint32_t> ended;
  for (const auto& [frame, file] : job.results.files) ended.insert(frame);
  for (const auto& [frame, reason] : job.results.failed) ended.insert(frame);
  state_.scheduler.AddJob(job, ended);
  uint64_t restored = 0;
  for (const auto& [frame, samples] : job.in_spool)
    restored += static_cast<uint64_t>(job.spec->frames[frame].spec.crop.area()) * samples;
  std::vector<uint32_t> complete;
  for (const auto& [frame, merger] : job.results.mergers) {
    restored += merger.samples_merged();
    job.results.samples_total -= SamplesOf(merger.spec()) - merger.samples_total();
    ResumeFrame(job, frame, merger);
    if (state_.scheduler.IsComplete(job, frame)) complete.push_back(frame);
  }
  for (const auto& [unit, votes] : votes_[job.id]) {
    for (const Vote& vote : votes) state_.scheduler.RestoreVote(unit, vote);
  }
  job.results.samples_done += restored;
  state_.output.log.push_back(fmt::format("job_resumed job={} frames_finished={} samples_restored={}",
                                          Number(job.id), job.results.files.size(), restored));
  state_.AddMessage(MessageLevel::kInfo, job.id,
                    fmt::format("the coordinator was restarted: {} of {} samples are kept",
                                job.results.samples_done, job.results.samples_total));
  for (const uint32_t frame : complete) frames_.Complete(job, frame);
  end_.EndIfDecided(now, job);
}

// Tells the scheduler what is merged, and which tiles stop because of it.
void FarmRecovery::ResumeFrame(Job& job, uint32_t frame, const Merger& merger) {
  merger.VisitNodes([&](uint32_t tile, SampleRange range, const SharedSums&) {
    state_.scheduler.RestoreDone(job.id, frame, {tile, range});
  });
  if (!merger.spec().IsAdaptive()) return;
  for (int tile = 0; tile < merger.spec().TileCount(); ++tile)
    state_.scheduler.SetGoal(job, frame, static_cast<uint32_t>(tile), merger.Goal(tile));
}

// The job as it was submitted, then what it was extended to, with the frames that were finished before.
void FarmRecovery::AppendHistory(const Job& job, std::vector<Fact>& facts) const {
  facts.emplace_back(TimedOf(state_, job));
  if (job.owner != JobOwner{}) facts.emplace_back(JobOwned{job.id, job.owner});
  if (job.order != nullptr) {
    facts.emplace_back(JobOrdered{job.id, job.order});
    return;
  }
  facts.emplace_back(JobSubmitted{job.id, job.submitted});
  if (job.spec == job.submitted) return;
  std::set<uint32_t> steps;
  for (const auto& [frame, samples] : job.in_spool) steps.insert(samples);
  for (const uint32_t step : steps) {
    facts.emplace_back(JobExtended{job.id, step});
    for (const auto& [frame, samples] : job.in_spool) {
      if (samples == step)
        facts.emplace_back(FrameFinished{job.id, frame, {}, job.results.frame_samples.at(frame)});
    }
  }
  uint32_t samples_max = 0;
  for (const FrameRequest& frame : job.spec->frames) {
    samples_max = std::max(samples_max, frame.spec.samples_per_pixel);
  }
  facts.emplace_back(JobExtended{job.id, samples_max});
}

// What people asked for and what verification has brought.
void FarmRecovery::AppendControl(const Job& job, std::vector<Fact>& facts) {
  if (job.is_paused) facts.emplace_back(JobPaused{job.id, true});
  if (job.priority != job.submitted->priority) facts.emplace_back(JobPriorityChanged{job.id, job.priority});
  for (const auto& [index, frame] : job.schedule.active) {
    frame.verification.VisitVotes(
        [&, index = index, key = frame.scene.key](TileSamples samples, const Vote& vote) {
          const WorkUnit unit{job.id, index, samples.tile, samples.range, key};
          facts.emplace_back(VoteRecorded{unit, vote.worker, vote.name, vote.result, vote.machine});
        });
  }
  if (job.submitted->verify_share > 0) facts.emplace_back(CountsOf(job));
}

std::vector<Fact> FarmRecovery::Snapshot() const {
  std::vector<Fact> facts{CoordinatorStarted{state_.epoch, state_.id},
                          JobsForgotten{JobId{Number(state_.jobs.next_id()) - 1}}};
  const auto& jobs = state_.jobs.all();
  const auto append_finished = [&](const Job& job, uint32_t frame) {
    facts.emplace_back(
        FrameFinished{job.id, frame, job.results.files.at(frame), job.results.frame_samples.at(frame)});
  };
  for (const auto& [id, job] : jobs) AppendHistory(job, facts);
  for (const auto& [id, job] : jobs) {
    for (const auto& [frame, file] : job.results.files) {
      if (!state_.kept_sums.Has({id, frame})) append_finished(job, frame);
    }
  }
  for (const FrameId kept : state_.kept_sums.Frames()) append_finished(jobs.at(kept.job), kept.frame);
  for (const auto& [id, job] : jobs) {
    for (const auto& [frame, reason] : job.results.failed) facts.emplace_back(FrameFailed{id, frame, reason});
    AppendControl(job, facts);
    if (HasEnded(job.state)) facts.emplace_back(JobEnded{id, job.state, job.reason});
  }
  for (const WorkerBlock& block : state_.scheduler.Blocks()) facts.emplace_back(FactOf(block));
  state_.membership.AppendSnapshot(facts);
  return facts;
}

}  // namespace tessera
