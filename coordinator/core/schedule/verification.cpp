#include "coordinator/core/schedule/verification.h"

#include <algorithm>

#include "coordinator/core/schedule/policy.h"
#include "renderer/util/check.h"
#include "renderer/util/hash.h"

namespace tessera {

bool Verification::IsChosen(TileSamples unit) const {
  if (share_ <= 0) return false;
  const uint64_t draw =
      Hash(key_, uint64_t{unit.tile}, uint64_t{unit.range.begin}, uint64_t{unit.range.size});
  return static_cast<double>(draw >> 11) * 0x1p-53 < share_;  // below 1: a share of 1 is every unit
}

bool Verification::Ballot::Knows(WorkerId worker) const {
  return holders.contains(worker) ||
         std::any_of(votes.begin(), votes.end(), [&](const Vote& each) { return each.worker == worker; });
}

bool Verification::Ballot::IsOfMachine(uint64_t machine, std::optional<WorkerId> besides) const {
  if (machine == 0) return false;
  return std::ranges::any_of(votes, [&](const Vote& each) { return each.machine == machine; }) ||
         std::ranges::any_of(
             holders, [&](const auto& each) { return each.second == machine && each.first != besides; });
}

// Two votes are needed, or one more than there are if all of those differ.
bool Verification::Ballot::IsWanting() const {
  return votes.size() + holders.size() < std::max<size_t>(2, votes.size() + 1);
}

void Verification::Update(Ballots::const_iterator ballot) {
  if (ballot->second.IsWanting()) {
    wanting_.insert(ballot->first);
  } else {
    wanting_.erase(ballot->first);
  }
}

void Verification::Begin(TileSamples unit) {
  const auto [ballot, is_new] = units_.try_emplace(unit);
  TESSERA_CHECK(is_new);
  Update(ballot);
}

void Verification::Remove(TileSamples unit) {
  units_.erase(unit);
  wanting_.erase(unit);
}

bool Verification::Abandon(TileSamples unit) {
  const auto ballot = units_.find(unit);
  if (ballot == units_.end() || !ballot->second.votes.empty() || !ballot->second.holders.empty())
    return false;
  Remove(unit);
  return true;
}

// Units of a tile do not overlap, so all that touch the samples lie between the last one that begins before
// them and their end.
bool Verification::Touches(TileSamples samples) const {
  auto ballot = units_.lower_bound({samples.tile, {samples.range.begin, 0}});
  if (ballot != units_.begin()) {
    const TileSamples before = std::prev(ballot)->first;
    if (before.tile == samples.tile && before.range.Overlaps(samples.range)) return true;
  }
  return ballot != units_.end() && ballot->first.tile == samples.tile &&
         ballot->first.range.Overlaps(samples.range);
}

std::vector<SampleRange> Verification::UnitsOf(uint32_t tile) const {
  std::vector<SampleRange> ranges;
  for (auto ballot = units_.lower_bound({tile, {0, 0}}); ballot != units_.end() && ballot->first.tile == tile;
       ++ballot) {
    ranges.push_back(ballot->first.range);
  }
  return ranges;
}

void Verification::Hold(TileSamples unit, Voter holder) {
  const auto ballot = units_.find(unit);
  if (ballot == units_.end()) return;
  ballot->second.holders[holder.worker] = holder.machine;
  ballot->second.wanting_since.reset();
  Update(ballot);
}

void Verification::Release(TileSamples unit, WorkerId worker) {
  const auto ballot = units_.find(unit);
  if (ballot == units_.end()) return;
  ballot->second.holders.erase(worker);
  Update(ballot);
}

bool Verification::NeedsVoteOf(TileSamples unit, Voter voter) const {
  return wanting_.contains(unit) && MayVote(unit, voter);
}

bool Verification::MayVote(TileSamples unit, Voter voter, std::optional<WorkerId> besides) const {
  const auto found = units_.find(unit);
  if (found == units_.end() || found->second.Knows(voter.worker)) return false;
  return found->second.is_relaxed || !found->second.IsOfMachine(voter.machine, besides);
}

std::optional<TileSamples> Verification::Find(Voter voter,
                                              const std::function<bool(uint32_t tile)>& may) const {
  for (const TileSamples unit : wanting_) {
    if (MayVote(unit, voter) && may(unit.tile)) return unit;
  }
  return std::nullopt;
}

bool Verification::Relax(Instant now, const FindCandidates& find) {
  bool has_relaxed = false;
  for (const TileSamples unit : wanting_) {
    Ballot& ballot = units_.at(unit);
    if (ballot.is_relaxed) continue;
    const Candidates candidates = find(ballot, unit.tile);
    if (candidates == Candidates::kNone) {
      ballot.wanting_since.reset();
      continue;
    }
    if (!ballot.wanting_since) ballot.wanting_since = now;
    const bool has_waited = now - *ballot.wanting_since >= kOtherMachinePatience;
    if (candidates == Candidates::kOtherMachine && !has_waited) continue;
    ballot.is_relaxed = has_relaxed = true;
  }
  return has_relaxed;
}

size_t Verification::CountStuck(const std::set<WorkerId>& workers) const {
  return static_cast<size_t>(std::count_if(wanting_.begin(), wanting_.end(), [&](TileSamples unit) {
    return std::none_of(workers.begin(), workers.end(),
                        [&](WorkerId worker) { return !units_.at(unit).Knows(worker); });
  }));
}

Verification::Quorum Verification::RecordVote(TileSamples unit, const Vote& vote, bool is_one_machine) {
  const auto ballot = units_.find(unit);
  TESSERA_CHECK(ballot != units_.end());
  std::vector<Vote>& votes = ballot->second.votes;
  const auto is_of_worker = [&](const Vote& each) { return each.worker == vote.worker; };
  if (std::any_of(votes.begin(), votes.end(), is_of_worker)) return {};
  const auto same = std::ranges::find(votes, vote.result, &Vote::result);
  Quorum quorum;
  quorum.is_reached = same != votes.end();
  const bool is_any_machine = is_one_machine || ballot->second.is_relaxed || vote.machine == 0;
  if (quorum.is_reached && !is_any_machine && same->machine == vote.machine) return {};
  quorum.is_new = true;
  quorum.is_disputed = !quorum.is_reached && !votes.empty() && !ballot->second.is_disputed;
  ballot->second.is_disputed |= quorum.is_disputed;
  votes.push_back(vote);
  quorum.votes = votes;
  if (!quorum.is_reached) {
    Update(ballot);
    return quorum;
  }
  std::copy_if(votes.begin(), votes.end(), std::back_inserter(quorum.dissenters),
               [&](const Vote& each) { return each.result != vote.result; });
  Remove(unit);
  return quorum;
}

void Verification::RestoreVote(TileSamples unit, const Vote& vote) {
  RecordVote(unit, vote, true);
}

void Verification::VisitVotes(const std::function<void(TileSamples unit, const Vote& vote)>& visit) const {
  for (const auto& [unit, ballot] : units_) {
    for (const Vote& vote : ballot.votes) visit(unit, vote);
  }
}

std::vector<TileSamples> Verification::Distrust(WorkerId worker) {
  std::vector<TileSamples> abandoned;
  for (auto ballot = units_.begin(); ballot != units_.end();) {
    const auto here = ballot++;
    std::erase_if(here->second.votes, [&](const Vote& each) { return each.worker == worker; });
    Update(here);
    const TileSamples unit = here->first;
    if (Abandon(unit)) abandoned.push_back(unit);
  }
  return abandoned;
}

}  // namespace tessera
