// What people ask for and what workers say of each other: units that two render, workers kept from work.
#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/farm.h"
#include "coordinator/core/policy.h"

namespace tessera {
namespace {

// Of the sums alone, bit for bit: bounds and range are the unit's.
Digest ResultDigest(const RadianceTile& tile) {
  return Sha256({reinterpret_cast<const char*>(tile.sums.data()), tile.sums.size() * sizeof tile.sums[0]});
}

}  // namespace

// Hears what the worker's result of the unit is: its verdict, or nothing if the result is believed.
std::optional<Verdict> Farm::Verify(Instant now, JobEntry& job, WorkerId worker,
                                    const ReturnedUnit& returned) {
  const Digest result = ResultDigest(*returned.tile);
  const auto hearing =
      scheduler_.Hear(now, worker, returned.lease, returned.unit, returned.render_seconds, result);
  if (hearing.is_new) {
    const OpinionHeard heard{returned.unit, worker, hearing.name, result};
    Count(job, heard);
    output_.facts.emplace_back(heard);
  }
  switch (hearing.outcome) {
    case Scheduler::Hearing::Outcome::kHeld: return Verdict::kAccepted;
    case Scheduler::Hearing::Outcome::kUseless: return Verdict::kDuplicate;
    case Scheduler::Hearing::Outcome::kBelieved: break;
  }
  return std::nullopt;
}

void Farm::Count(JobEntry& job, const OpinionHeard& heard) {
  std::vector<Opinion>& opinions = job.opinions[heard.unit];
  const bool decided = std::any_of(opinions.begin(), opinions.end(),
                                   [&](const Opinion& each) { return each.result == heard.result; });
  if (!decided && opinions.size() == 1) ++job.units_disputed;
  opinions.push_back({heard.worker, heard.name, heard.result});
  if (!decided) return;
  ++job.units_verified;
  job.opinions.erase(heard.unit);
}

void Farm::RestoreControl(const Fact& fact) {
  if (const auto* pause = std::get_if<JobPaused>(&fact)) {
    if (JobEntry* const job = FindJob(pause->job)) job->paused = pause->paused;
  } else if (const auto* changed = std::get_if<JobPriorityChanged>(&fact)) {
    if (JobEntry* const job = FindJob(changed->job)) job->priority = changed->priority;
  } else if (const auto* bar = std::get_if<WorkerBarred>(&fact)) {
    former_bars_.push_back(*bar);
  } else if (const auto* heard = std::get_if<OpinionHeard>(&fact)) {
    if (JobEntry* const job = FindJob(heard->unit.job)) Count(*job, *heard);
  } else if (const auto* counted = std::get_if<UnitsCounted>(&fact)) {
    JobEntry* const job = FindJob(counted->job);
    if (job == nullptr) return;
    job->units_verified = counted->verified;
    job->units_disputed = counted->disputed;
    job->units_suspect = counted->suspect;
  }
}

// What RestoreControl makes the job of again.
void Farm::AppendControl(const JobEntry& job, std::vector<Fact>& facts) const {
  if (job.paused) facts.emplace_back(JobPaused{job.id, true});
  if (job.priority != job.submitted->priority) facts.emplace_back(JobPriorityChanged{job.id, job.priority});
  for (const auto& [unit, opinions] : job.opinions) {
    for (const Opinion& each : opinions) {
      facts.emplace_back(OpinionHeard{unit, each.worker, each.name, each.result});
    }
  }
  if (job.submitted->verify_share > 0) facts.emplace_back(CountsOf(job));
}

UnitsCounted Farm::CountsOf(const JobEntry& job) {
  return {job.id, job.units_verified, job.units_disputed, job.units_suspect};
}

WorkerBarred Farm::FactOf(const Scheduler::Bar& bar) {
  return {bar.worker, bar.name, bar.drained, bar.quarantine};
}

void Farm::NoteBars() {
  for (const Scheduler::Bar& bar : scheduler_.TakeBars()) output_.facts.emplace_back(FactOf(bar));
}

// What workers that are not believed any more have in open jobs already.
void Farm::NoteSuspects() {
  for (const WorkerId worker : scheduler_.TakeDisbelieved()) {
    for (const JobId id : open_jobs_) {
      JobEntry& job = jobs_.at(id);
      const auto merged = job.unconfirmed.find(worker);
      if (merged == job.unconfirmed.end()) continue;
      const uint64_t units = merged->second;
      job.unconfirmed.erase(merged);
      job.units_suspect += units;
      output_.facts.emplace_back(CountsOf(job));
      output_.log.push_back(
          fmt::format("results_suspect job={} worker={:016x} units={}", Number(id), Number(worker), units));
    }
  }
}

std::vector<WorkerStatus> Farm::FindWorkers(Instant now, const std::string& which) const {
  std::vector<WorkerStatus> found = Workers(now);
  std::erase_if(found, [&](const WorkerStatus& worker) {
    return worker.name != which && fmt::format("{:016x}", Number(worker.worker)) != which;
  });
  return found;
}

}  // namespace tessera
