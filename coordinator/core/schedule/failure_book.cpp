#include "coordinator/core/schedule/failure_book.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/schedule/policy.h"

namespace tessera {
namespace {

// Of a large farm all that are needed to understand the problem.
constexpr size_t kReasonsShownMax = 8;

std::string ReasonsOf(const std::map<WorkerId, const FailureBook::Entry*>& failures) {
  std::string reasons;
  size_t shown = 0;
  for (const auto& [worker, entry] : failures) {
    if (!reasons.empty()) reasons += "; ";
    if (shown++ == kReasonsShownMax)
      return reasons + fmt::format("and {} more", failures.size() - kReasonsShownMax);
    reasons += entry->reason;
  }
  return reasons;
}

}  // namespace

void FailureBook::Record(Entry entry, FailureCause cause) {
  if (!entry.samples) {
    auto& known = cause == FailureCause::kScene ? scene_->failures : scene_->limits;
    if (known.size() < kSceneFailuresKeptMax) known.try_emplace(entry.worker, std::move(entry));
    return;
  }
  const bool known = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& each) {
    return each.worker == entry.worker && each.samples == entry.samples;
  });
  if (!known && entries_.size() < kFailuresKeptMax) entries_.push_back(std::move(entry));
}

bool FailureBook::HasFailed(WorkerId worker, uint32_t tile) const {
  if (HasFailedScene(worker)) return true;
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& each) { return each.worker == worker && each.samples->tile == tile; });
}

void FailureBook::SetSuspects(bool scene, std::set<uint32_t> tiles) {
  scene_->is_suspect = scene;
  suspect_tiles_ = std::move(tiles);
}

std::vector<WorkerId> FailureBook::Disprove(uint32_t tile, WorkerId by,
                                            const std::function<bool(TileSamples)>& is_done) {
  std::vector<WorkerId> at_fault;
  std::erase_if(entries_, [&](const Entry& each) {
    const bool disproved = each.samples->tile == tile && is_done(*each.samples);
    if (disproved && each.worker != by) at_fault.push_back(each.worker);
    return disproved;
  });
  for (const auto& [worker, entry] : scene_->failures) {
    if (worker != by) at_fault.push_back(worker);
  }
  scene_->failures.clear();
  return at_fault;
}

FailureBook::Failures FailureBook::Against(std::optional<uint32_t> tile) const {
  Failures failures;
  // What was failed of the scene's tiles may have other causes than the scene.
  for (const Entry& each : entries_) {
    if (each.samples->tile == tile) failures.emplace(each.worker, &each);
  }
  // Whoever failed the scene failed all its tiles.
  for (const auto* const each : {&scene_->failures, &scene_->limits}) {
    for (const auto& [worker, entry] : *each) failures.emplace(worker, &entry);
  }
  return failures;
}

std::set<std::optional<uint32_t>> FailureBook::Failed() const {
  std::set<std::optional<uint32_t>> failed{std::nullopt};
  for (const Entry& each : entries_) failed.insert(each.samples->tile);
  return failed;
}

std::optional<FailureBook::Reason> FailureBook::FatalReason(
    int attempts_max, const std::function<std::set<Party>()>& find_parties) const {
  const auto needed = static_cast<size_t>(attempts_max);
  for (const auto& tile : Failed()) {
    Failures failures = Against(tile);
    std::erase_if(failures, [&](const auto& each) {
      const bool is_of_scene = !each.second->samples;
      return is_of_scene && (scene_->is_rendered || scene_->limits.contains(each.first));
    });
    if (failures.size() < needed) continue;
    std::set<Party> failed;
    for (const auto& [worker, entry] : failures) failed.insert(PartyOf(entry->member, worker));
    std::set<Party> all = failed;
    if (failed.size() < needed) all.merge(find_parties());
    if (failed.size() >= std::min(needed, all.size())) return Reason{!tile, ReasonsOf(failures)};
  }
  return std::nullopt;
}

std::optional<FailureBook::Reason> FailureBook::ReasonOfAll(const std::set<WorkerId>& workers,
                                                            bool is_fatal) const {
  for (const auto& tile : Failed()) {
    Failures failures = Against(tile);
    std::erase_if(failures, [&](const auto& each) { return !workers.contains(each.first); });
    if (failures.size() < workers.size()) continue;
    const bool is_tried =
        std::ranges::any_of(failures, [](const auto& each) { return each.second->samples.has_value(); });
    if (is_fatal && scene_->is_rendered && !is_tried) continue;
    return Reason{!tile, ReasonsOf(failures)};
  }
  return std::nullopt;
}

std::optional<FailureBook::Reason> FailureBook::ReasonOfAll(const std::set<WorkerId>& workers) const {
  return ReasonOfAll(workers, false);
}

std::optional<FailureBook::Reason> FailureBook::FatalReasonOfAll(Instant now,
                                                                 const std::set<WorkerId>& workers,
                                                                 Instant grace) {
  auto reason = workers.empty() ? std::nullopt : ReasonOfAll(workers, true);
  if (!reason) {
    none_may_since_.reset();
  } else if (!none_may_since_) {
    none_may_since_ = now;
  }
  return reason && now - *none_may_since_ >= grace ? reason : std::nullopt;
}

}  // namespace tessera
