#include "coordinator/core/preparations.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "coordinator/core/schedule/policy.h"
#include "proto/frame_name.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// Between looks at the workers, unless there is news.
constexpr Instant kPreparationInterval = milliseconds(250);
// Jobs that a worker is looked for in one of these, each of which looks at all workers. The others follow.
constexpr int kAttemptsPerLookMax = 64;

// The lines of render options without those that differ from frame to frame.
std::string WithoutFrame(std::string_view options) {
  std::string kept;
  while (!options.empty()) {
    const size_t end = std::min(options.find('\n'), options.size() - 1) + 1;
    const std::string_view line = options.substr(0, end);
    const std::string_view key = line.substr(0, line.find('='));
    const bool is_of_frame = key == "time" || key == "time-step" || key == "frame" || key == "fps";
    if (!is_of_frame) kept += line;
    options.remove_prefix(end);
  }
  return kept;
}

// Whether a job with these frames is the one that was ordered, as far as that can be checked without its
// scene.
bool AreOf(const std::vector<FrameRequest>& frames, const SceneOrder& order) {
  const std::vector<int> numbers = order.frames ? order.frames->Numbers() : std::vector<int>{0};
  const FrameName name(order.scene_file);
  if (frames.size() != numbers.size()) return false;
  for (size_t i = 0; i < frames.size(); ++i) {
    const FrameRequest& frame = frames[i];
    const std::string file = order.frames ? name.Of(numbers[i]) : order.scene_file;
    if (frame.number != numbers[i] || frame.scene_file != file ||
        WithoutFrame(frame.options) != order.options)
      return false;
  }
  return true;
}

using Owner = std::pair<MemberId, std::string>;

Owner OwnerOf(const Job& job) {
  return {job.owner.member, job.owner.name};
}

// Each reason once, after the names of the workers that have it: most have the same.
std::string ReasonsOf(const std::map<WorkerId, Preparations::Failure>& failures) {
  std::map<std::string, std::set<std::string>> workers_by_reason;
  for (const auto& [worker, failure] : failures) workers_by_reason[failure.reason].insert(failure.worker);
  std::string reasons;
  for (const auto& [reason, workers] : workers_by_reason)
    reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", fmt::join(workers, ", "), reason);
  return reasons;
}

}  // namespace

// Returns nullptr if the job has ended.
Job* Preparations::OpenJob(JobId id) const {
  Job* const job = state_.jobs.Find(id);
  return job == nullptr || HasEnded(job->state) ? nullptr : job;
}

bool Preparations::Preparation::HasFailed(const Party& party) const {
  return std::ranges::any_of(failures, [&](const auto& each) { return each.second.party == party; });
}

bool Preparations::Preparation::IsClosedTo(WorkerId id, const Party& party, int attempts_max) const {
  const auto of_party =
      std::ranges::count_if(failures, [&](const auto& each) { return each.second.party == party; });
  return failures.contains(id) || of_party >= attempts_max;
}

void Preparations::Begin() {
  for (const JobId id : state_.jobs.open()) {
    if (const Job& job = state_.jobs.At(id); job.order != nullptr) Add(job);
  }
}

bool Preparations::HasPlace(const JobOwner& owner) const {
  const auto waiting = std::ranges::count_if(open_, [&](const auto& each) {
    const Job* const job = OpenJob(each.first);
    return job != nullptr && job->owner == owner;
  });
  return static_cast<size_t>(waiting) < kOrdersPerOwnerMax;
}

void Preparations::Add(const Job& job) {
  open_[job.id].key = PreparationKey(*job.order);
  due_ = {};
}

void Preparations::Advance(Instant now) {
  CountLosses(now);
  std::erase_if(overdue_, [&](const auto& each) { return !state_.scheduler.IsConnected(each.first); });
  std::erase_if(open_, [&](const auto& each) { return OpenJob(each.first) == nullptr; });
  if (open_.empty() || now < due_) return;
  due_ = now + kPreparationInterval;
  for (auto& [job, preparation] : open_) {
    CheckWorker(now, state_.jobs.At(job), preparation);
    JudgeLosses(now, state_.jobs.At(job), preparation);
  }
  Assign(now);
  FailHopeless(now);
}

void Preparations::CountLosses(Instant now) {
  const uint64_t lost = state_.scheduler.counters().workers_lost;
  if (lost_.empty() || lost_.back().second != lost) lost_.emplace_back(now, lost);
  while (lost_.size() > 1 && now - lost_[1].first > kSilentLossSettles + 2 * kCrowdWindow) lost_.pop_front();
}

// Whether too many others were lost at the same time for the scene to be the cause.
bool Preparations::IsOneOfCrowd(Instant at) const {
  const auto count_until = [this](Instant until) {
    uint64_t count = lost_.front().second;
    for (const auto& [when, lost] : lost_) {
      if (when <= until) count = lost;
    }
    return count;
  };
  const uint64_t lost = count_until(at + kCrowdWindow) - count_until(at - kCrowdWindow);
  return lost > std::max<uint64_t>(1, state_.scheduler.WorkerCount() / kCrowdDivisor);
}

void Preparations::JudgeLosses(Instant now, Job& job, Preparation& preparation) {
  std::vector<WorkerId> alone;
  std::erase_if(preparation.losses, [&](const auto& loss) {
    if (now - loss.second < kSilentLossSettles) return false;
    if (!state_.scheduler.IsConnected(loss.first) && !IsOneOfCrowd(loss.second)) alone.push_back(loss.first);
    return true;
  });
  for (const WorkerId worker : alone)
    Fail(now, job, preparation, worker, "was lost while it prepared the scene");
}

// A worker that drains finishes what it has begun.
void Preparations::CheckWorker(Instant now, Job& job, Preparation& preparation) {
  if (!preparation.worker) return;
  const WorkerId worker = *preparation.worker;
  if (!state_.scheduler.IsConnected(worker)) {
    if (preparation.is_listed) {
      preparation.losses.emplace_back(worker, now);
      preparation.rests_until = now + kTrialRest;
    }
    preparation.worker.reset();
  } else if (!state_.scheduler.MayWork(worker) && !preparation.is_listed) {
    preparation.worker.reset();
  } else if (preparation.listed_for >= kPreparationDurationMax) {
    overdue_.emplace(worker, preparation.key);
    constexpr auto kMinutes = std::chrono::duration_cast<std::chrono::minutes>(kPreparationDurationMax);
    Fail(now, job, preparation, worker, fmt::format("did not finish in {} minutes", kMinutes.count()));
  }
}

// The least loaded worker. Those that let this preparation lapse, have not finished another one in time, or
// whose member has failed it with another worker, only if there are no others.
std::optional<WorkerId> Preparations::WorkerFor(const Preparation& preparation,
                                                const std::set<WorkerId>& busy) const {
  std::set<WorkerId> excluded = busy, avoided;
  if (!preparation.failures.empty()) {
    for (const auto& [worker, party] : state_.scheduler.AbleWorkers()) {
      if (preparation.IsClosedTo(worker, party, attempts_max_)) excluded.insert(worker);
      if (preparation.HasFailed(party)) avoided.insert(worker);
    }
  }
  avoided.insert(excluded.begin(), excluded.end());
  avoided.insert(preparation.lapsed.begin(), preparation.lapsed.end());
  for (const auto& [worker, key] : overdue_) avoided.insert(worker);
  const auto worker = state_.scheduler.LeastLoaded(avoided);
  return worker ? worker : state_.scheduler.LeastLoaded(excluded);
}

void Preparations::Assign(Instant now) {
  std::vector<Job*> waiting;
  std::set<WorkerId> busy;
  std::set<Owner> served;
  for (const auto& [id, preparation] : open_) {
    Job* const job = OpenJob(id);
    if (job == nullptr) continue;
    if (preparation.worker) {
      busy.insert(*preparation.worker);
      served.insert(OwnerOf(*job));
    } else if (!job->is_paused) {
      waiting.push_back(job);
    }
  }
  std::ranges::stable_sort(waiting, std::ranges::greater(), [](const Job* job) { return job->priority; });
  int attempts = 0;
  for (Job* const job : waiting) {
    Preparation& preparation = open_.at(job->id);
    job->order_problem = ReasonsOf(preparation.failures);
    if (served.contains(OwnerOf(*job)) || now < preparation.rests_until) continue;
    if (++attempts > kAttemptsPerLookMax) return;
    const auto worker = WorkerFor(preparation, busy);
    if (!worker && busy.empty() && preparation.failures.empty())
      job->order_problem = state_.scheduler.WhyNoWorker();
    if (!worker) continue;
    preparation.worker = worker;
    preparation.is_sent = preparation.is_listed = false;
    preparation.lapses_at = now + kLeaseUnlistedMax;
    preparation.listed_at = now;
    preparation.listed_for = {};
    busy.insert(*worker);
    served.insert(OwnerOf(*job));
  }
}

void Preparations::FailHopeless(Instant now) {
  const std::map<WorkerId, Party> able = state_.scheduler.AbleWorkers();
  if (able.empty()) return;
  for (auto& [id, preparation] : open_) {
    const auto has_failed = [&, &preparation = preparation](const auto& each) {
      return preparation.IsClosedTo(each.first, each.second, attempts_max_);
    };
    Job& job = state_.jobs.At(id);
    const bool is_settled = preparation.losses.empty() && !preparation.failures.empty();
    if (preparation.worker || !is_settled || now - preparation.failed_at < kPoisonGrace ||
        HasEnded(job.state))
      continue;
    if (std::ranges::all_of(able, has_failed))
      end_.End(now, job, JobState::kFailed,
               "the scene cannot be prepared: " + ReasonsOf(preparation.failures));
  }
}

void Preparations::Synchronize(Instant now, const WorkerState& state) {
  const auto is_listed = [&](const Digest& key) {
    return std::ranges::find(state.preparations, key) != state.preparations.end();
  };
  std::erase_if(overdue_,
                [&](const auto& each) { return each.first == state.worker && !is_listed(each.second); });
  for (auto& [id, preparation] : open_) {
    if (preparation.worker != state.worker) continue;
    preparation.is_listed = is_listed(preparation.key);
    if (preparation.is_listed) {
      // A jump of the clock is no time that the worker has had.
      preparation.listed_for += std::min(now - preparation.listed_at, kLeaseDuration);
      preparation.listed_at = now;
      preparation.lapses_at = now + kLeaseDuration;
    }
    if (state.leaving || now >= preparation.lapses_at) {
      if (!state.leaving) preparation.lapsed.insert(state.worker);
      preparation.worker.reset();
      due_ = {};
    } else if (!preparation.is_listed && now - preparation.sent_at >= kAnnounceAgain) {
      preparation.is_sent = false;
    }
  }
}

std::vector<WorkerId> Preparations::News() const {
  std::vector<WorkerId> workers;
  for (const auto& [id, preparation] : open_) {
    if (preparation.worker && !preparation.is_sent && OpenJob(id) != nullptr)
      workers.push_back(*preparation.worker);
  }
  return workers;
}

std::optional<PreparationRequest> Preparations::Take(Instant now, WorkerId worker) {
  for (auto& [id, preparation] : open_) {
    const Job* const job = OpenJob(id);
    if (preparation.worker != worker || preparation.is_sent || job == nullptr) continue;
    preparation.is_sent = true;
    preparation.sent_at = now;
    return PreparationRequest{preparation.key, job->order->scene};
  }
  return std::nullopt;
}

void Preparations::Return(Instant now, WorkerId worker, const PreparationReport& report) {
  const auto found =
      std::ranges::find_if(open_, [&](const auto& each) { return each.second.key == report.key; });
  Job* const job = found != open_.end() ? OpenJob(found->first) : nullptr;
  if (job == nullptr) return;
  due_ = {};
  if (!state_.scheduler.IsTrusted(worker)) {
    if (found->second.worker == worker) found->second.worker.reset();
    return;
  }
  if (!report.reason.empty()) return Fail(now, *job, found->second, worker, report.reason);
  if (!AreOf(report.frames, job->order->scene))
    return Fail(now, *job, found->second, worker, "returned frames that were not ordered");
  Admit(now, *job, report);
  open_.erase(found);
}

void Preparations::Fail(Instant now, Job& job, Preparation& preparation, WorkerId worker,
                        const std::string& reason) {
  const std::string name = state_.scheduler.NameOf(worker);
  if (preparation.worker == worker) preparation.worker.reset();
  const Party party = PartyOf(state_.scheduler.MemberOf(worker).value_or(MemberId{}), worker);
  if (preparation.IsClosedTo(worker, party, attempts_max_)) return;
  state_.output.log.push_back(fmt::format("preparation_failed worker={:016x} name={} job={} reason={}",
                                          Number(worker), LogText(name), Number(job.id), LogText(reason)));
  state_.AddMessage(MessageLevel::kWarning, job.id,
                    fmt::format("worker {} did not prepare the scene: {}", name, reason));
  preparation.failures.try_emplace(worker, Failure{name, reason, party});
  preparation.failed_at = now;
  job.order_problem = ReasonsOf(preparation.failures);
  if (HasFailedForAll(preparation))
    end_.End(now, job, JobState::kFailed, "the scene cannot be prepared: " + job.order_problem);
}

// Whether enough workers of enough parties have failed it.
bool Preparations::HasFailedForAll(const Preparation& preparation) const {
  const auto needed = static_cast<size_t>(attempts_max_);
  if (preparation.failures.size() < needed) return false;
  std::set<Party> failed;
  for (const auto& [worker, failure] : preparation.failures) failed.insert(failure.party);
  std::set<Party> all = failed;
  if (failed.size() < needed) {
    for (const auto& [worker, party] : state_.scheduler.AbleWorkers()) all.insert(party);
  }
  return failed.size() >= std::min(needed, all.size());
}

// The job is from now on like one that came with its frames.
void Preparations::Admit(Instant now, Job& job, const PreparationReport& report) {
  JobSpec spec = *job.spec;
  spec.frames = report.frames;
  if (const auto room = state_.jobs.CheckSpecBytes(MemoryOf(spec)); !room)
    return end_.End(now, job, JobState::kFailed, room.error().message);
  const auto shared = std::make_shared<const JobSpec>(std::move(spec));
  state_.jobs.SetFrames(job, shared);
  job.clock = {};
  job.clock.begun = state_.scheduler.counters();
  state_.scheduler.AddJob(job);
  state_.output.facts.emplace_back(JobSubmitted{job.id, shared});
  state_.output.log.push_back(fmt::format("job_prepared job={} frames={} samples={}", Number(job.id),
                                          shared->frames.size(), job.results.samples_total));
  for (const std::string& warning : report.warnings)
    state_.AddMessage(MessageLevel::kWarning, job.id, warning);
}

}  // namespace tessera
