#include "coordinator/core/schedule/failure_book.h"

#include <algorithm>

#include "coordinator/core/schedule/policy.h"

namespace tessera {
namespace {

std::string ReasonsOf(const std::map<WorkerId, const FailureBook::Entry*>& failures) {
  std::string reasons;
  for (const auto& [worker, entry] : failures) {
    if (!reasons.empty()) reasons += "; ";
    reasons += entry->reason;
  }
  return reasons;
}

}  // namespace

void FailureBook::Record(Entry entry) {
  if (!entry.samples) {
    scene_->failures.try_emplace(entry.worker, std::move(entry));
    return;
  }
  const bool known = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& each) {
    return each.worker == entry.worker && each.samples == entry.samples;
  });
  if (!known && entries_.size() < kFailuresKeptMax) entries_.push_back(std::move(entry));
}

bool FailureBook::HasFailed(WorkerId worker, uint32_t tile) const {
  if (scene_->failures.contains(worker)) return true;
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
  // Whoever failed the scene failed all its tiles. What was failed of its tiles may have other causes.
  for (const auto& [worker, entry] : scene_->failures) failures.emplace(worker, &entry);
  if (!tile) return failures;
  for (const Entry& each : entries_) {
    if (each.samples->tile == *tile) failures.emplace(each.worker, &each);
  }
  return failures;
}

std::set<std::optional<uint32_t>> FailureBook::Failed() const {
  std::set<std::optional<uint32_t>> failed{std::nullopt};
  for (const Entry& each : entries_) failed.insert(each.samples->tile);
  return failed;
}

std::optional<std::string> FailureBook::FatalReason(int attempts_max) const {
  for (const auto& tile : Failed()) {
    const Failures failures = Against(tile);
    if (failures.size() >= static_cast<size_t>(attempts_max)) return ReasonsOf(failures);
  }
  return std::nullopt;
}

std::optional<std::string> FailureBook::FatalReasonOfAll(const std::set<WorkerId>& workers,
                                                         Instant before) const {
  for (const auto& tile : Failed()) {
    const Failures failures = Against(tile);
    const bool all = std::all_of(workers.begin(), workers.end(),
                                 [&](WorkerId worker) { return failures.contains(worker); });
    const bool settled = std::all_of(failures.begin(), failures.end(),
                                     [&](const auto& each) { return each.second->at <= before; });
    if (all && settled) return ReasonsOf(failures);
  }
  return std::nullopt;
}

}  // namespace tessera
