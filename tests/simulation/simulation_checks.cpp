// The clients of a simulated farm, and what they and an observer of all messages hold against it.
#include <fmt/format.h>

#include <algorithm>

#include "renderer/film/adaptive.h"
#include "tests/simulation/simulation.h"

namespace tessera {
namespace {

constexpr Instant kClientRetry = seconds(3);

}  // namespace

void Simulation::Violation(const std::string& what) {
  Trace("VIOLATION " + what);
  report_.violations.push_back(fmt::format("{:.6f}: {}", Seconds(queue_.now()), what));
}

void Simulation::MakeJobs() {
  for (int j = 0; j < options_.jobs; ++j) {
    JobModel model;
    auto spec = std::make_shared<JobSpec>();
    spec->submission = static_cast<uint64_t>(j) + 1;
    spec->name = fmt::format("job{}", j);
    spec->priority = random_.Int(0, 1);
    spec->verify_share = options_.verify_share;
    const int frames = random_.Int(1, 2);
    for (int f = 0; f < frames; ++f) {
      spec->frames.push_back({fmt::format("scene{}.pbrt", f), "", DrawFrame(), f});
      const uint64_t seed = Hash(spec->submission, static_cast<uint64_t>(f));
      model.reference.push_back(ReferenceMerger(seed, spec->frames.back().spec));
      model.pictures.push_back(model.reference.back().Picture());
      report_.samples_needed += model.reference.back().samples_total();
    }
    model.spec = spec;
    model.cost = random_.Real(0.00005, 0.001);
    model.poisoned = options_.poison && j == 0;
    jobs_.push_back(model);
    queue_.After(random_.Duration(0, 10), [this, job = jobs_.size() - 1] { Submit(job); });
  }
  if (options_.cancel_one) queue_.After(random_.Duration(0, 20), [this] { Cancel(0); });
}

FrameSpec Simulation::DrawFrame() {
  const auto samples = static_cast<uint32_t>(random_.Int(1, 64));
  const int width = random_.Int(5, 24);
  const int height = random_.Int(5, 24);
  FrameSpec frame = SmallFrame(width, height, 8, samples);
  if (options_.noise_threshold == 0 || random_.Chance(0.5)) return frame;
  frame.SetNoiseThreshold(options_.noise_threshold);
  AddChannel(frame.channels, SamplesChannel(true));
  frame.samples_per_pixel += kDecisionSamplesMin;  // so that there is something to decide
  return frame;
}

// A client submits the same again until it is told that the farm has it.
void Simulation::Submit(size_t j) {
  if (jobs_[j].acknowledged) return;
  Send([this, j] {
    if (!farm_ || jobs_[j].acknowledged) return;
    const auto id = farm_->Submit(FarmNow(), jobs_[j].spec);
    if (!id) return Violation("a job is turned away: " + id.error().message);
    after_sync_.push_back([this, j, id = *id] {
      Send([this, j, id] {
        Trace(fmt::format("client job={} id={}", jobs_[j].spec->name, Number(id)));
        jobs_[j].acknowledged = true;
      });
    });
    Touch();
  });
  queue_.After(kClientRetry, [this, j] { Submit(j); });
}

void Simulation::Cancel(size_t j) {
  if (HasEnded(jobs_[j].told)) return;
  queue_.After(kClientRetry, [this, j] { Cancel(j); });
  if (!jobs_[j].acknowledged) return;
  jobs_[j].cancelled = true;
  Send([this, j] {
    if (!farm_) return;
    if (!farm_->Cancel(FarmNow(), jobs_[j].id)) Violation("a job cannot be cancelled");
    Touch();
  });
}

// An open job that the farm knows, for a wish about it.
Simulation::JobModel* Simulation::SomeOpenJob() {
  JobModel& job = jobs_[static_cast<size_t>(random_.Int(0, options_.jobs - 1))];
  const auto status = farm_ && job.acknowledged ? farm_->Status(FarmNow(), job.id) : std::nullopt;
  return status && !HasEnded(status->state) ? &job : nullptr;
}

void Simulation::WishPause() {
  const bool paused = random_.Chance(0.5);
  const JobModel* const job = SomeOpenJob();
  if (job == nullptr) return;
  if (!farm_->SetPaused(FarmNow(), job->id, paused)) Violation("a job cannot be paused");
  Touch();
}

void Simulation::WishPriority() {
  const int priority = random_.Int(-1, 2);
  const JobModel* const job = SomeOpenJob();
  if (job == nullptr) return;
  if (!farm_->SetPriority(FarmNow(), job->id, priority)) Violation("a priority cannot be changed");
  Touch();
}

// Whoever paused a job lets it go on in the end.
void Simulation::ResumeAll() {
  bool all_heard = farm_ != nullptr;
  for (const JobModel& job : jobs_) {
    const auto status = farm_ && job.acknowledged ? farm_->Status(FarmNow(), job.id) : std::nullopt;
    if (status && !HasEnded(status->state)) (void)farm_->SetPaused(FarmNow(), job.id, false);
    all_heard = all_heard && (!status || !status->paused_by_user);
  }
  if (farm_) Touch();
  if (!all_heard) queue_.After(kClientRetry, [this] { ResumeAll(); });
}

Simulation::JobModel* Simulation::ModelOf(JobId id) {
  const auto found = std::ranges::find(jobs_, id, [](const JobModel& job) { return job.id; });
  return found == jobs_.end() ? nullptr : &*found;
}

// What is on the disk may be told to anybody, and must be true for ever.
void Simulation::NoteFact(const Fact& fact) {
  if (const auto* submitted = std::get_if<JobSubmitted>(&fact)) {
    jobs_[submitted->spec->submission - 1].id = submitted->job;
  } else if (const auto* ended = std::get_if<JobEnded>(&fact)) {
    ModelOf(ended->job)->told = ended->state;
  } else if (const auto* finished = std::get_if<FrameFinished>(&fact)) {
    const FrameSpec& spec = ModelOf(finished->job)->spec->frames[finished->frame].spec;
    for (uint32_t tile = 0; tile < static_cast<uint32_t>(spec.TileCount()); ++tile) {
      for (const SampleRange range : DyadicPartition(spec.samples_per_pixel)) {
        ledger_.Acknowledge({finished->job, finished->frame, tile, range});
      }
    }
  }
}

// I4: what was acknowledged is not rendered again. Nor is anything that one machine alone would not have
// rendered, since the tile or its pixels stop before.
void Simulation::CheckGrant(const Lease& lease) {
  const WorkUnit& unit = lease.unit;
  const auto status = farm_->Status(FarmNow(), unit.job);
  if (status && status->paused_by_user) Violation("a unit of a paused job is leased: " + unit.Text());
  // What is verified is rendered more than once.
  if (options_.verify_share == 0 && ledger_.Holds(unit))
    Violation("leased though acknowledged: " + unit.Text());
  const uint64_t submission = farm_->Spec(unit.job)->submission;  // the job may not be journalled yet
  const Merger& reference = jobs_[submission - 1].reference[unit.frame];
  if (unit.range.end() > reference.Goal(static_cast<int>(unit.tile)).samples)
    Violation("leased though its tile stops before: " + unit.Text());
  if (!reference.spec().IsAdaptive()) return;
  const FramePicture& picture = jobs_[submission - 1].pictures[unit.frame];
  const std::vector<float> samples = picture.Channel(kSamplesChannel);
  size_t pixel = 0;
  for (int y = lease.bounds.y0; y < lease.bounds.y1; ++y) {
    for (int x = lease.bounds.x0; x < lease.bounds.x1; ++x, ++pixel) {
      const auto place = static_cast<size_t>(y * picture.bounds.width() + x);
      if (lease.pixels.Has(pixel) != (samples[place] >= static_cast<float>(unit.range.end())))
        return Violation("leased with other pixels than are wanted: " + unit.Text());
    }
  }
}

void Simulation::CheckGrants(const FarmOutput& output) {
  const auto check = [&](const std::vector<Lease>& leases) {
    for (const Lease& lease : leases) {
      if (!ledger_.IsNew(lease.id)) continue;
      Trace(fmt::format("lease {} {}", Number(lease.id), lease.unit.Text()));
      CheckGrant(lease);
    }
  };
  for (const auto& each : output.directives) check(each.directive.leases);
  for (const auto& each : output.results) check(each.grants.leases);
}

// I2 and I3: whatever came in whatever order, the picture is that of one machine, to the last bit.
void Simulation::CheckPicture(const FinishedPicture& finished) {
  const FramePicture& wanted = ModelOf(finished.job)->pictures[finished.frame];
  Trace(fmt::format("picture job={} frame={}", Number(finished.job), finished.frame));
  const FramePicture picture = finished.snapshot.Picture();
  if (picture.values != wanted.values) Violation("a picture is not the reference");
}

// I4: a new process of the coordinator knows what the former told.
void Simulation::CheckMemory() {
  for (const JobModel& job : jobs_) {
    if (!job.acknowledged) continue;
    const auto status = farm_->Status(FarmNow(), job.id);
    if (!status) {
      Violation("a job is forgotten: " + job.spec->name);
    } else if (HasEnded(job.told) && status->state != job.told) {
      Violation(fmt::format("{} was {} and is {}", job.spec->name, JobStateName(job.told),
                            JobStateName(status->state)));
    }
  }
}

bool Simulation::AllEnded() {
  return farm_ != nullptr && std::ranges::all_of(jobs_, [&](const JobModel& job) {
           return job.acknowledged && HasEnded(job.told);
         });
}

// I5: each job has ended, and as it should.
void Simulation::CheckEnd() {
  for (const JobModel& job : jobs_) {
    const auto status = farm_ ? farm_->Status(FarmNow(), job.id) : std::nullopt;
    if (!status) {
      Violation("a job is forgotten at the end: " + job.spec->name);
      continue;
    }
    // Two lies and the truth are three opinions of which none can be believed.
    const bool may_fail =
        job.poisoned || options_.one_fails_units || options_.one_damages_results || options_.one_lies;
    const std::string what =
        fmt::format("{} is {} with {} of {} samples ({})", job.spec->name, JobStateName(status->state),
                    status->samples_done, status->samples_total, status->reason);
    if (!HasEnded(status->state)) Violation("not ended: " + what);
    if (job.poisoned && status->state == JobState::kFinished) Violation("a poisoned job finished: " + what);
    if (status->state == JobState::kFailed && !may_fail) Violation("failed without cause: " + what);
    if (status->state == JobState::kCancelled && !job.cancelled) Violation("cancelled by nobody: " + what);
    if (status->state == JobState::kFinished && status->samples_done != status->samples_total) {
      Violation("finished early: " + what);
    }
  }
}

}  // namespace tessera
