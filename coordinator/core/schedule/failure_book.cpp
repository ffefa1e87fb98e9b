#include "coordinator/core/schedule/failure_book.h"

#include <algorithm>

#include "coordinator/core/schedule/policy.h"

namespace tessera {
namespace {

// A failure of the scene is a failure of all its tiles.
bool HitsTile(const FailureBook::Entry& entry, uint32_t tile) {
  return !entry.samples || entry.samples->tile == tile;
}

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
  if (!entry.samples) failed_scene_.insert(entry.worker);
  const bool known = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& each) {
    return each.worker == entry.worker && each.samples == entry.samples;
  });
  if (!known && entries_.size() < kFailuresKeptMax) entries_.push_back(std::move(entry));
}

bool FailureBook::May(WorkerId worker, uint32_t tile) const {
  if (failed_scene_.contains(worker)) return false;
  return std::none_of(entries_.begin(), entries_.end(),
                      [&](const Entry& each) { return each.worker == worker && HitsTile(each, tile); });
}

std::vector<WorkerId> FailureBook::Disprove(uint32_t tile, WorkerId by,
                                            const std::function<bool(TileSamples)>& is_done) {
  std::vector<WorkerId> at_fault;
  std::erase_if(entries_, [&](const Entry& each) {
    if (each.worker == by) return false;
    const bool disproved = !each.samples || (each.samples->tile == tile && is_done(*each.samples));
    if (disproved) at_fault.push_back(each.worker);
    return disproved;
  });
  return at_fault;
}

std::map<WorkerId, const FailureBook::Entry*> FailureBook::Against(const Entry& entry) const {
  std::map<WorkerId, const Entry*> failures;
  for (const Entry& each : entries_) {
    // For a failed scene only failures of the scene count: those of its tiles may have other causes.
    const bool counts = entry.samples ? HitsTile(each, entry.samples->tile) : !each.samples;
    if (counts) failures.emplace(each.worker, &each);
  }
  return failures;
}

std::optional<std::string> FailureBook::FatalReason(int attempts_max) const {
  for (const Entry& entry : entries_) {
    const auto failures = Against(entry);
    if (failures.size() >= static_cast<size_t>(attempts_max)) return ReasonsOf(failures);
  }
  return std::nullopt;
}

std::optional<std::string> FailureBook::FatalReasonOfAll(const std::set<WorkerId>& workers,
                                                         Instant before) const {
  for (const Entry& entry : entries_) {
    const auto failures = Against(entry);
    const bool all = std::all_of(workers.begin(), workers.end(),
                                 [&](WorkerId worker) { return failures.contains(worker); });
    const bool settled = std::all_of(failures.begin(), failures.end(),
                                     [&](const auto& each) { return each.second->at <= before; });
    if (all && settled) return ReasonsOf(failures);
  }
  return std::nullopt;
}

}  // namespace tessera
