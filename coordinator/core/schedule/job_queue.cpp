#include "coordinator/core/schedule/job_queue.h"

#include <algorithm>

#include "coordinator/core/schedule/policy.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

// Each job is asked about the same frame many times.
const ActiveFrames::Size& SizeOf(Job& job, uint32_t frame) {
  auto& sized = job.schedule.sized;
  if (!sized || sized->first != frame)
    sized.emplace(frame, ActiveFrames::SizeOf(job.spec->frames[frame].spec));
  return sized->second;
}

}  // namespace

void JobQueue::Add(Job& job) {
  const bool is_new = open_.emplace(job.id, &job).second;
  TESSERA_CHECK(is_new);
  if (!job.is_paused) Register(job);
}

void JobQueue::Remove(Job& job) {
  Unregister(job);
  open_.erase(job.id);
}

void JobQueue::Unregister(const Job& job) {
  const auto equals = runnable_.find(job.priority);
  if (equals == runnable_.end()) return;
  equals->second.erase(job.id);
  if (equals->second.empty()) runnable_.erase(equals);
}

void JobQueue::SetPaused(Job& job, bool is_paused) {
  job.is_paused = is_paused;
  if (is_paused) {
    Unregister(job);
  } else {
    Register(job);
  }
}

void JobQueue::SetPriority(Job& job, int priority) {
  Unregister(job);
  job.priority = priority;
  if (!job.is_paused) Register(job);
}

Job* JobQueue::Find(JobId id) {
  const auto found = open_.find(id);
  return found == open_.end() ? nullptr : found->second;
}

const Job* JobQueue::Find(JobId id) const {
  const auto found = open_.find(id);
  return found == open_.end() ? nullptr : found->second;
}

bool JobQueue::MayBegin(Job& job, uint32_t frame) {
  if (active_.HasRoom(SizeOf(job, frame))) return true;
  const bool is_first = !runnable_.empty() && *runnable_.begin()->second.begin() == job.id;
  if (is_first && job.schedule.active.size() < 2 && MayStretch(job, frame)) return true;
  has_refused_ = true;
  return false;
}

bool JobQueue::MayStretch(Job& job, uint32_t frame) {
  return active_.HasRoom(SizeOf(job, frame), kActiveStretch);
}

ActiveFrame& JobQueue::Begin(Job& job, uint32_t index) {
  ActiveFrame& frame = job.Begin(index);
  std::erase_if(scene_histories_, [](const auto& each) { return each.second.expired(); });
  auto& known = scene_histories_[frame.scene.key];
  auto history = known.lock();
  if (history == nullptr) known = history = std::make_shared<FailureBook::SceneHistory>();
  frame.place = active_.Count(SizeOf(job, index));
  frame.failures = FailureBook(std::move(history));
  return frame;
}

ActiveFrame* JobQueue::FindFrame(const WorkUnit& unit) {
  Job* const job = Find(unit.job);
  if (job == nullptr) return nullptr;
  const auto found = job->schedule.active.find(unit.frame);
  return found == job->schedule.active.end() ? nullptr : &found->second;
}

ActiveFrame* JobQueue::FindOrBegin(const WorkUnit& unit) {
  Job* const job = Find(unit.job);
  if (job != nullptr && job->schedule.ahead.contains(unit.frame)) return &Begin(*job, unit.frame);
  return FindFrame(unit);
}

bool JobQueue::IsKnown(const WorkUnit& unit) const {
  const Job* const job = Find(unit.job);
  if (job == nullptr) return false;
  const JobSchedule& schedule = job->schedule;
  if (!schedule.active.contains(unit.frame) && !schedule.ahead.contains(unit.frame)) return false;
  if (!job->Has(unit)) return false;
  const FrameSpec& spec = job->spec->frames[unit.frame].spec;
  return IsUnitRange(spec, unit.range) && unit.tile < static_cast<uint32_t>(spec.TileCount());
}

std::optional<double> JobQueue::OpenCost(const Job& job) {
  if (!job.schedule.ahead.empty()) return std::nullopt;
  double cost = 0;
  for (const auto& [index, frame] : job.schedule.active) {
    const auto open = frame.work.OpenCost();
    if (!open) return std::nullopt;
    cost += *open;
  }
  return cost * (1 + job.spec->verify_share);
}

double JobQueue::UnitSeconds(const Job& job, int total_slots, double total_speed) {
  const double longest = std::max(kUnitDurationMax_s, total_slots / kResultsPerSecondMax);
  const double shortest = std::max(kUnitDurationMin_s, total_slots / kResultsPerSecondBurst);
  const auto open = OpenCost(job);
  if (!open || total_speed <= 0) return longest;
  return std::clamp(*open / total_speed / kGuidedDivisor, shortest, longest);
}

std::vector<Digest> JobQueue::PackagesAhead() const {
  std::vector<Digest> ahead;
  for (const auto& [priority, jobs] : runnable_) {
    for (const JobId id : jobs) {
      if (ahead.size() > kScenesAheadMax) return ahead;
      const Job& job = At(id);
      // Of a package with many scenes a worker needs what its frames need, and those are not known yet.
      if (!job.schedule.has_one_scene || !job.schedule.HasOpen()) continue;
      const Digest& package = job.spec->package;
      if (std::find(ahead.begin(), ahead.end(), package) == ahead.end()) ahead.push_back(package);
    }
  }
  return ahead;
}

}  // namespace tessera
