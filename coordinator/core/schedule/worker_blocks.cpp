// Which workers are kept from work, and what counts towards it.
#include <algorithm>

#include "coordinator/core/schedule/worker_roster.h"

namespace tessera {

bool WorkerRoster::AddStrike(WorkerRecord& worker) {
  if (worker.is_quarantined()) return false;
  worker.units_since_strike = 0;
  ++worker.strikes;
  UpdateFaulty(worker);
  return worker.strikes >= kStrikesMax;
}

void WorkerRoster::CreditUnit(WorkerRecord& worker) {
  ++worker.units_finished;
  if (++worker.units_since_strike >= kForgivenessUnits) worker.strikes = 0;
}

bool WorkerRoster::Quarantine(WorkerRecord& worker, const std::string& reason) {
  if (worker.is_quarantined()) return false;
  worker.quarantine = reason;
  worker.wanted.clear();
  NoteBlock(worker);
  return true;
}

bool WorkerRoster::Drain(WorkerRecord& worker) {
  if (worker.is_drained) return false;
  worker.is_drained = true;
  worker.wanted.clear();
  NoteBlock(worker);
  return true;
}

bool WorkerRoster::Release(WorkerRecord& worker) {
  if (!worker.is_blocked()) return false;
  worker.is_drained = false;
  worker.quarantine.clear();
  worker.strikes = 0;
  NoteBlock(worker);
  return true;
}

void WorkerRoster::NoteBlock(WorkerRecord& worker) {
  changed_blocks_.push_back({worker.id, worker.name, worker.is_drained, worker.quarantine});
  worker.pending.has_notice = true;
  news_.insert(worker.id);
  UpdateTotals(worker);
  UpdateGone(worker);
}

void WorkerRoster::RestoreBlock(Instant now, const WorkerBlock& block) {
  if (is_full() && Find(block.worker) == nullptr) return;
  WorkerRecord& worker = FindOrAdd(block.worker);
  worker.name = block.name;
  worker.is_drained = block.is_drained;
  worker.quarantine = block.quarantine;
  worker.last_contact = now;
  UpdateGone(worker);
}

WorkerBlock WorkerRoster::InheritedBlock(const WorkerRecord& gone, const WorkerRecord& worker) {
  WorkerBlock block{worker.id, worker.name, false, ""};
  if (gone.name != worker.name || (gone.has_joined && gone.member != worker.member)) return block;
  block.is_drained = gone.is_drained;
  // Without a certificate, a restart ends a quarantine: it may have repaired the worker.
  const bool is_same_machine = !gone.has_joined || gone.machine == worker.machine;
  if (worker.member != MemberId{} && is_same_machine) block.quarantine = gone.quarantine;
  return block;
}

std::optional<WorkerId> WorkerRoster::TakeOverBlock(WorkerRecord& worker) {
  for (const WorkerId id : gone_blocked_) {
    WorkerRecord& gone = At(id);
    const WorkerBlock block = InheritedBlock(gone, worker);
    if (!block.is_drained && block.quarantine.empty()) continue;
    worker.is_drained = block.is_drained;
    worker.quarantine = block.quarantine;
    NoteBlock(worker);
    Release(gone);
    gone.pending = {};
    UpdateNews(gone);
    return id;
  }
  return std::nullopt;
}

// Whether no other worker of its member has this machine.
bool WorkerRoster::IsNewMachine(const WorkerRecord& worker) const {
  return std::ranges::none_of(workers_, [&](const auto& each) {
    const WorkerRecord& other = each.second;
    return other.id != worker.id && other.has_joined && other.member == worker.member &&
           other.machine == worker.machine;
  });
}

void WorkerRoster::TakeOverStrikes(WorkerRecord& worker) {
  const auto of_member = gone_faulty_.find(worker.member);
  if (of_member == gone_faulty_.end()) return;
  const bool may_be_any = worker.machine == 0 || IsNewMachine(worker);
  for (const WorkerId id : std::set<WorkerId>(of_member->second)) {
    WorkerRecord& gone = At(id);
    if (!may_be_any && gone.machine != 0 && gone.machine != worker.machine) continue;
    worker.strikes += gone.is_quarantined() ? kStrikesMax : std::exchange(gone.strikes, 0);
    UpdateFaulty(gone);
  }
  worker.strikes = std::min(worker.strikes, kStrikesMax - 1);
}

std::vector<WorkerBlock> WorkerRoster::Blocks() const {
  std::vector<WorkerBlock> blocks;
  for (const auto& [id, worker] : workers_) {
    if (worker.is_blocked()) blocks.push_back({id, worker.name, worker.is_drained, worker.quarantine});
  }
  return blocks;
}

// Call after every change of whether the worker is connected or faulty.
void WorkerRoster::UpdateFaulty(WorkerRecord& worker) {
  const auto is_of = !worker.is_live && worker.is_faulty() ? std::optional(worker.member) : std::nullopt;
  if (is_of == worker.faulty_of_) return;
  if (worker.faulty_of_) {
    const auto of = gone_faulty_.find(*worker.faulty_of_);
    of->second.erase(worker.id);
    if (of->second.empty()) gone_faulty_.erase(of);
  }
  if (is_of) gone_faulty_[*is_of].insert(worker.id);
  worker.faulty_of_ = is_of;
}

}  // namespace tessera
