#include "coordinator/core/schedule/suspect_trials.h"

#include <algorithm>

#include "coordinator/core/schedule/policy.h"

namespace tessera {

void SuspectTrials::Lose(Instant now, const WorkerRecord& worker, bool is_silent) {
  if (worker.is_leaving || worker.is_drained) return;  // it was about to end
  std::map<Suspect, LossBook::InHand> in_hand;
  const auto add = [&](const Suspect& what, SampleRange range, Instant since) {
    const auto [known, is_new] = in_hand.try_emplace(what, LossBook::InHand{what, range, since});
    known->second.since = std::min(known->second.since, since);
  };
  const auto add_loading = [&](const Digest& scene) {
    const auto told = worker.loading_since.find(scene);
    add({scene}, {}, told == worker.loading_since.end() ? Instant{} : told->second);
  };
  for (const auto& [scene, is_ready] : worker.scenes) {
    if (!is_ready) add_loading(scene);
  }
  for (const SceneRequest& wanted : worker.wanted) {
    if (!worker.scenes.contains(wanted.key) && worker.loading_since.contains(wanted.key))
      add_loading(wanted.key);
  }
  for (const LeaseId id : state_.leases.OfWorker(worker.id)) {
    const LeaseRecord& record = state_.leases.At(id);
    if (record.IsWaiting(now)) continue;
    const WorkUnit& unit = record.lease.unit;
    const Digest& scene = state_.jobs.At(unit.job).schedule.active.at(unit.frame).scene.key;
    add({scene}, {}, record.announced_at);
    add({scene, unit.job, unit.frame, unit.tile}, unit.range, record.announced_at);
  }
  std::vector<LossBook::InHand> all;
  all.reserve(in_hand.size());
  for (const auto& [what, each] : in_hand) all.push_back(each);
  state_.losses.Lose(now, {worker.id, worker.member, worker.name, is_silent, state_.workers.size()}, all);
}

bool SuspectTrials::IsWanted(const Suspect& what) const {
  if (!what.is_scene()) {
    const Job* const job = state_.jobs.Find(what.job);
    return job != nullptr && job->schedule.active.contains(what.frame);
  }
  return std::ranges::any_of(state_.jobs.open(), [&](const auto& job) {
    return std::ranges::any_of(job.second->schedule.active,
                               [&](const auto& frame) { return frame.second.scene.key == what.scene; });
  });
}

bool SuspectTrials::IsRunnable(const Suspect& what) const {
  return std::ranges::any_of(state_.jobs.open(), [&](const auto& each) {
    const Job& job = *each.second;
    if (job.is_paused) return false;
    return what.is_scene()
               ? std::ranges::any_of(job.schedule.active,
                                     [&](const auto& frame) { return frame.second.scene.key == what.scene; })
               : job.id == what.job;
  });
}

// Whether there is a worker of another party that may, or may as soon as a job is resumed.
bool SuspectTrials::MayOthersTry(const Suspect& what, const std::set<Party>& parties) const {
  if (!IsRunnable(what)) return true;
  return std::ranges::any_of(state_.workers.all(), [&](const auto& each) {
    const WorkerRecord& worker = each.second;
    return worker.may_work() && !parties.contains(PartyOf(worker.member, worker.id)) &&
           Find(what, worker).has_value();
  });
}

// Whoever has lost workers with it tries it again only if no other party may: a member that ends its
// processes could keep it from all others.
bool SuspectTrials::IsLeftToOthers(const Suspect& what, const WorkerRecord& worker) const {
  if (worker.member == MemberId{}) return false;
  const std::set<Party> parties = state_.losses.PartiesOf(what);
  return parties.contains(PartyOf(worker.member, worker.id)) && MayOthersTry(what, parties);
}

void SuspectTrials::Advance(Instant now) {
  LossBook& losses = state_.losses;
  if (losses.empty()) return;
  for (const WorkerId id : losses.Triers()) {
    const WorkerRecord* const trier = state_.workers.Find(id);
    if (trier == nullptr || !trier->may_work()) losses.EndTrial(id);
  }
  losses.Keep([&](const Suspect& what) { return IsWanted(what); });
  const auto killers = losses.Killers(
      now, [&](const Suspect& what, const std::set<Party>& parties) { return MayOthersTry(what, parties); });
  for (const LossBook::Killer& killer : killers) {
    if (!killer.what.is_scene()) {
      failures_.FailJob(killer.what.job, killer.reason);
      continue;
    }
    for (const auto& [id, job] : state_.jobs.open()) {
      const bool has_it = std::ranges::any_of(job->schedule.active, [&](const auto& frame) {
        return frame.second.scene.key == killer.what.scene;
      });
      if (has_it) failures_.FailJob(id, killer.reason);
    }
  }
  if (!losses.Untried(now, Instant::max()).empty()) state_.idle.UnblockAll();
}

void SuspectTrials::Mark() {
  if (!state_.losses.TakeChanged()) return;
  const std::set<Suspect>& suspects = state_.losses.suspects();
  for (const auto& [id, job] : state_.jobs.open()) {
    for (auto& [index, frame] : job->schedule.active) {
      std::set<uint32_t> tiles;
      for (auto each = suspects.lower_bound({frame.scene.key, id, index, 0});
           each != suspects.end() && each->scene == frame.scene.key && each->job == id &&
           each->frame == index;
           ++each) {
        tiles.insert(each->tile);
      }
      frame.failures.SetSuspects(suspects.contains({frame.scene.key}), std::move(tiles));
    }
  }
  for (const Suspect& what : suspects) {
    if (what.is_scene()) StopLoading(what.scene);
  }
  state_.idle.UnblockAll();
}

// Workers that were told to load the scene and have not begun need not.
void SuspectTrials::StopLoading(const Digest& scene) {
  for (auto& [id, worker] : state_.workers.all()) {
    if (worker.wanted.empty() || worker.scenes.contains(scene)) continue;
    const auto trial = state_.losses.TrialOf(id);
    if (trial && trial->scene == scene) continue;
    std::erase_if(worker.wanted, [&](const SceneRequest& wanted) { return wanted.key == scene; });
  }
}

std::optional<SuspectTrials::Trial> SuspectTrials::TrialOf(Instant now, const WorkerRecord& worker) {
  LossBook& losses = state_.losses;
  if (losses.suspects().empty()) return std::nullopt;
  if (const auto what = losses.TrialOf(worker.id)) {
    auto trial = Find(*what, worker);
    if (!trial) losses.EndTrial(worker.id);
    return trial;
  }
  for (const Suspect& what : losses.Untried(now, worker.last_contact)) {
    if (IsLeftToOthers(what, worker)) continue;
    auto trial = Find(what, worker);
    if (!trial) continue;
    losses.BeginTrial(what, worker.id);
    return trial;
  }
  return std::nullopt;
}

std::string SuspectTrials::WhyOnTrial(const Job& job) const {
  for (const Suspect& what : state_.losses.suspects()) {
    const bool is_of_it =
        what.is_scene()
            ? std::ranges::any_of(job.schedule.active,
                                  [&](const auto& each) { return each.second.scene.key == what.scene; })
            : what.job == job.id;
    if (is_of_it) return state_.losses.Describe(what);
  }
  return {};
}

std::optional<SuspectTrials::Trial> SuspectTrials::Find(const Suspect& what,
                                                        const WorkerRecord& worker) const {
  if (!what.is_scene()) {
    Job* const job = state_.jobs.Find(what.job);
    if (job == nullptr || job->is_paused) return std::nullopt;
    return FindIn(*job, what.frame, what, worker);
  }
  for (const auto& [priority, jobs] : state_.jobs.runnable()) {
    for (const JobId id : jobs) {
      Job& job = state_.jobs.At(id);
      for (const auto& [index, frame] : job.schedule.active) {
        if (frame.scene.key != what.scene) continue;
        if (auto trial = FindIn(job, index, what, worker)) return trial;
      }
    }
  }
  return std::nullopt;
}

std::optional<SuspectTrials::Trial> SuspectTrials::FindIn(Job& job, uint32_t index, const Suspect& what,
                                                          const WorkerRecord& worker) const {
  const auto frame = job.schedule.active.find(index);
  if (frame == job.schedule.active.end() || !worker.has_tags(job.spec->required_tags)) return std::nullopt;
  Trial trial{{&job, index, &frame->second}, std::nullopt};
  if (!what.is_scene()) trial.tile = what.tile;
  const auto may = [&](uint32_t tile) { return trial.Allows(worker.id, tile); };
  // What it holds of the suspect is its trial, too.
  const std::vector<LeaseId>& leases = state_.leases.OfWorker(worker.id);
  const bool is_trying = std::ranges::any_of(leases, [&](LeaseId id) {
    const WorkUnit& unit = state_.leases.At(id).lease.unit;
    return unit.job == job.id && unit.frame == index && may(unit.tile);
  });
  const ActiveFrame& active = frame->second;
  if (!is_trying && !active.work.HasOpen(may) && !active.verification.Find(state_.VoterOf(worker), may))
    return std::nullopt;
  return trial;
}

}  // namespace tessera
