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
  const auto quorum = frame.verification.RecordVote({unit.tile, unit.range}, vote);
  state_.idle.UnblockAll();  // the unit may need another worker by now
  if (!quorum.is_new) return {};
  const size_t different = quorum.votes.size() - (quorum.is_reached ? 1 : 0);
  if (different > 1) {
    state_.log.push_back(fmt::format("result_disputed unit={} workers={}", LogText(unit.Text()),
                                     LogText(NamesOf(quorum.votes))));
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
  return {quorum.is_reached ? VoteOutcome::Kind::kAccepted : VoteOutcome::Kind::kHeld, true, vote.name};
}

void VoteCounting::RestoreVote(const WorkUnit& unit, const Vote& vote) {
  const WorkerRecord* const worker = state_.workers.Find(vote.worker);
  if (!state_.jobs.IsKnown(unit) || (worker != nullptr && worker->is_quarantined())) return;
  ActiveFrame& frame = *state_.jobs.FindOrBegin(unit);
  const TileSamples samples{unit.tile, unit.range};
  if (JoinVerification(frame, samples)) frame.verification.RecordVote(samples, vote);
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
