#include "coordinator/core/schedule/vote_counting.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

std::string NamesOf(const std::vector<Vote>& votes) {
  std::string names;
  for (const Vote& each : votes) names += (names.empty() ? "" : ", ") + each.name;
  return names;
}

}  // namespace

bool VoteCounting::NeedsVote(const WorkUnit& unit) {
  const TileSamples samples{unit.tile, unit.range};
  const Verification& verification = state_.jobs.FindFrame(unit)->verification;
  return verification.IsChosen(samples) || verification.Touches(samples);
}

bool VoteCounting::JoinVerification(ActiveFrame& frame, TileSamples samples) {
  if (frame.verification.IsVerifying(samples)) return true;
  if (!frame.verification.IsChosen(samples) || !frame.work.TakeExactly(samples)) return false;
  frame.verification.Begin(samples);
  state_.idle.UnblockAll();  // others may render it as well
  return true;
}

VoteOutcome VoteCounting::RecordVote(const WorkUnit& unit, const Vote& vote) {
  ActiveFrame& frame = *state_.jobs.FindFrame(unit);
  const auto quorum = frame.verification.RecordVote({unit.tile, unit.range}, vote, state_.IsOneMachine());
  state_.idle.UnblockAll();  // the unit may need another worker
  if (!quorum.is_new) return {};
  const size_t different = quorum.votes.size() - (quorum.is_reached ? 1 : 0);
  if (different > 1) {
    state_.log.push_back(fmt::format("result_disputed unit={} workers={}", LogText(unit.Text()),
                                     LogText(NamesOf(quorum.votes))));
    state_.Warn(unit.job, fmt::format("workers disagree about {}: {}",
                                      UnitText(*state_.jobs.At(unit.job).spec, unit), NamesOf(quorum.votes)));
  }
  for (const Vote& dissenter : quorum.dissenters) {
    Distrust(dissenter.worker,
             fmt::format("its result of {} differs from that of two other workers", unit.Text()));
  }
  const bool is_exhausted = different >= static_cast<size_t>(std::max(2, attempts_max_));
  if (!quorum.is_reached && is_exhausted) {
    failures_.FailJob(unit.job,
                      fmt::format("the results of {} differ on every worker that rendered it ({}), so "
                                  "none of them can be trusted",
                                  unit.Text(), NamesOf(quorum.votes)));
  }
  return {quorum.is_reached ? VoteOutcome::Kind::kAccepted : VoteOutcome::Kind::kHeld, vote,
          quorum.is_disputed};
}

Verification::Candidates VoteCounting::CandidatesFor(const Verification::Ballot& ballot,
                                                     const FailureBook& failures, uint32_t tile,
                                                     const WorkersByMachine& able) const {
  using Candidates = Verification::Candidates;
  Candidates found = state_.awaits_workers ? Candidates::kOtherMachine : Candidates::kNone;
  for (const auto& [machine, workers] : able) {
    const bool can_vote = std::ranges::any_of(
        workers, [&](WorkerId worker) { return !ballot.Knows(worker) && failures.May(worker, tile); });
    if (!can_vote) continue;
    if (!ballot.IsOfMachine(machine)) return Candidates::kOtherMachine;
    found = std::max(found, Candidates::kSameMachine);
  }
  return found;
}

void VoteCounting::Relax(Instant now) {
  std::map<std::set<std::string>, WorkersByMachine> able;  // by required tags
  const auto able_for = [&](const std::set<std::string>& tags) -> const WorkersByMachine& {
    const auto [known, is_new] = able.try_emplace(tags);
    if (is_new) {
      for (const WorkerId id : state_.workers.AbleFor(tags))
        known->second[state_.workers.At(id).machine].push_back(id);
    }
    return known->second;
  };
  bool has_relaxed = false;
  for (const auto& [id, job] : state_.jobs.open()) {
    if (job->spec->verify_share <= 0) continue;
    const auto& tags = job->spec->required_tags;
    for (auto& [index, frame] : job->schedule.active) {
      has_relaxed |= frame.verification.Relax(
          now, [&, &failures = frame.failures](const Verification::Ballot& ballot, uint32_t tile) {
            return CandidatesFor(ballot, failures, tile, able_for(tags));
          });
    }
  }
  if (has_relaxed) state_.idle.UnblockAll();
}

void VoteCounting::RestoreVote(const WorkUnit& unit, const Vote& vote) {
  const WorkerRecord* const worker = state_.workers.Find(vote.worker);
  if (!state_.jobs.IsKnown(unit) || (worker != nullptr && worker->is_quarantined())) return;
  ActiveFrame& frame = *state_.jobs.FindOrBegin(unit);
  const TileSamples samples{unit.tile, unit.range};
  if (JoinVerification(frame, samples)) frame.verification.RestoreVote(samples, vote);
}

// The votes of the worker are void. What was merged from it before cannot be told from the rest any more.
void VoteCounting::Distrust(WorkerId id, const std::string& reason) {
  distrusted_.push_back(id);
  for (const auto& [job_id, job] : state_.jobs.open()) {
    for (auto& [index, frame] : job->schedule.active) {
      for (const TileSamples samples : frame.verification.Distrust(id)) {
        leases_.Reopen({job_id, index, samples.tile, samples.range}, frame);
      }
    }
  }
  if (WorkerRecord* const worker = state_.workers.Find(id)) failures_.Quarantine(*worker, reason);
}

}  // namespace tessera
