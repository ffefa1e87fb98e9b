#include "coordinator/core/verification.h"

#include <algorithm>

#include "renderer/util/check.h"
#include "renderer/util/hash.h"

namespace tessera {

bool Verification::IsChosen(TileSamples unit) const {
  if (share_ <= 0) return false;
  const uint64_t draw =
      Hash(key_, uint64_t{unit.tile}, uint64_t{unit.range.begin}, uint64_t{unit.range.size});
  return static_cast<double>(draw >> 11) * 0x1p-53 < share_;  // below 1: a share of 1 is every unit
}

bool Verification::Trial::Knows(WorkerId worker) const {
  return holders.contains(worker) || std::any_of(opinions.begin(), opinions.end(),
                                                 [&](const Opinion& each) { return each.worker == worker; });
}

// Two opinions are needed, and one more than there are if all of those differ.
bool Verification::Trial::IsWanting() const {
  return opinions.size() + holders.size() < std::max<size_t>(2, opinions.size() + 1);
}

void Verification::Update(Trials::const_iterator trial) {
  if (trial->second.IsWanting()) {
    wanting_.insert(trial->first);
  } else {
    wanting_.erase(trial->first);
  }
}

void Verification::Begin(TileSamples unit) {
  const auto [trial, is_new] = trials_.try_emplace(unit);
  TESSERA_CHECK(is_new);
  Update(trial);
}

void Verification::Drop(TileSamples unit) {
  trials_.erase(unit);
  wanting_.erase(unit);
}

bool Verification::Abandon(TileSamples unit) {
  const auto trial = trials_.find(unit);
  if (trial == trials_.end() || !trial->second.opinions.empty() || !trial->second.holders.empty())
    return false;
  Drop(unit);
  return true;
}

// Trials of a tile do not overlap, so all that touch the samples lie between the last that begins before them
// and their end.
bool Verification::Touches(TileSamples samples) const {
  auto trial = trials_.lower_bound({samples.tile, {samples.range.begin, 0}});
  if (trial != trials_.begin()) {
    const TileSamples before = std::prev(trial)->first;
    if (before.tile == samples.tile && before.range.Overlaps(samples.range)) return true;
  }
  return trial != trials_.end() && trial->first.tile == samples.tile &&
         trial->first.range.Overlaps(samples.range);
}

std::vector<SampleRange> Verification::TrialsOf(uint32_t tile) const {
  std::vector<SampleRange> ranges;
  for (auto trial = trials_.lower_bound({tile, {0, 0}}); trial != trials_.end() && trial->first.tile == tile;
       ++trial) {
    ranges.push_back(trial->first.range);
  }
  return ranges;
}

void Verification::Hold(TileSamples unit, WorkerId worker) {
  const auto trial = trials_.find(unit);
  if (trial == trials_.end()) return;
  trial->second.holders.insert(worker);
  Update(trial);
}

void Verification::Release(TileSamples unit, WorkerId worker) {
  const auto trial = trials_.find(unit);
  if (trial == trials_.end()) return;
  trial->second.holders.erase(worker);
  Update(trial);
}

bool Verification::Wants(TileSamples unit, WorkerId worker) const {
  return wanting_.contains(unit) && Admits(unit, worker);
}

bool Verification::Admits(TileSamples unit, WorkerId worker) const {
  const auto trial = trials_.find(unit);
  return trial != trials_.end() && !trial->second.Knows(worker);
}

std::optional<TileSamples> Verification::Find(WorkerId worker,
                                              const std::function<bool(uint32_t tile)>& may) const {
  for (const TileSamples unit : wanting_) {
    if (Admits(unit, worker) && may(unit.tile)) return unit;
  }
  return std::nullopt;
}

size_t Verification::CountStuck(const std::set<WorkerId>& workers) const {
  return static_cast<size_t>(std::count_if(wanting_.begin(), wanting_.end(), [&](TileSamples unit) {
    return std::none_of(workers.begin(), workers.end(),
                        [&](WorkerId worker) { return Admits(unit, worker); });
  }));
}

Verification::Judgement Verification::Hear(TileSamples unit, const Opinion& opinion) {
  const auto trial = trials_.find(unit);
  TESSERA_CHECK(trial != trials_.end());
  std::vector<Opinion>& opinions = trial->second.opinions;
  const auto is_speaker = [&](const Opinion& each) { return each.worker == opinion.worker; };
  if (std::any_of(opinions.begin(), opinions.end(), is_speaker)) return {};
  Judgement judgement;
  judgement.is_new = true;
  judgement.decided = std::any_of(opinions.begin(), opinions.end(),
                                  [&](const Opinion& each) { return each.result == opinion.result; });
  opinions.push_back(opinion);
  judgement.opinions = opinions;
  if (!judgement.decided) {
    Update(trial);
    return judgement;
  }
  std::copy_if(opinions.begin(), opinions.end(), std::back_inserter(judgement.dissenters),
               [&](const Opinion& each) { return each.result != opinion.result; });
  Drop(unit);
  return judgement;
}

std::vector<TileSamples> Verification::Disbelieve(WorkerId worker) {
  std::vector<TileSamples> abandoned;
  for (auto trial = trials_.begin(); trial != trials_.end();) {
    const auto here = trial++;
    std::erase_if(here->second.opinions, [&](const Opinion& each) { return each.worker == worker; });
    Update(here);
    const TileSamples unit = here->first;
    if (Abandon(unit)) abandoned.push_back(unit);
  }
  return abandoned;
}

}  // namespace tessera
