#include "tests/simulation/simulation.h"

#include <fmt/format.h>

#include <algorithm>

namespace tessera {
namespace {

constexpr double kHealedLimit_s = 400;  // simulated seconds in which a healed farm must end every job

}  // namespace

SimulationOptions DrawOptions(uint64_t seed) {
  Random random(Hash(seed, 77));
  SimulationOptions options;
  options.workers = random.Int(1, 6);
  options.jobs = random.Int(1, 3);
  options.loss = random.Chance(0.5) ? random.Real(0, 0.3) : 0;
  options.duplication = random.Chance(0.5) ? random.Real(0, 0.3) : 0;
  options.delay_max_s = random.Chance(0.5) ? random.Real(0, 1) : 0.002;
  options.death_interval_s = random.Chance(0.5) ? random.Real(2, 30) : 0;
  options.hang_interval_s = random.Chance(0.5) ? random.Real(2, 30) : 0;
  options.crash_interval_s = random.Chance(0.4) ? random.Real(5, 40) : 0;
  options.one_fails_units = random.Chance(0.3);
  options.one_damages_results = random.Chance(0.3);
  options.poison = random.Chance(0.15);
  options.cancel_one = random.Chance(0.15);
  return options;
}

Simulation::Simulation(uint64_t seed, SimulationOptions options)
    : options_(options), random_(Hash(seed, 1)) {}

void Simulation::Violation(const std::string& what) {
  report_.violations.push_back(At() + "us: " + what);
}

void Simulation::StartFarm() {
  farm_ = std::make_unique<Farm>(SchedulerOptions{++epoch_});
  for (const std::string& bytes : journal_) {
    const auto fact = DecodeFact(bytes);
    if (!fact) {
      Violation("a fact cannot be read back");
      continue;
    }
    farm_->Restore(*fact);
  }
  farm_->Begin(queue_.now());
  Touch();
}

void Simulation::CrashFarm() {
  Trace(At() + " crash");
  farm_.reset();
  directive_calls_.clear();
  results_calls_.clear();
  for (JobModel& job : jobs_) job.pictures.clear();  // those acknowledged are known by their facts
  queue_.After(random_.Duration(0, 3), [this] { StartFarm(); });
}

void Simulation::SubmitJobs() {
  for (int j = 0; j < options_.jobs; ++j) {
    JobModel model;
    auto spec = std::make_shared<JobSpec>();
    spec->submission = static_cast<uint64_t>(j) + 1;
    spec->name = fmt::format("job{}", j);
    spec->priority = random_.Int(0, 1);
    const int frames = random_.Int(1, 2);
    for (int f = 0; f < frames; ++f) {
      const auto samples = static_cast<uint32_t>(random_.Int(1, 100));
      const int width = random_.Int(5, 24);
      const int height = random_.Int(5, 24);
      spec->frames.push_back({fmt::format("scene{}.pbrt", f), "", SmallFrame(width, height, 8, samples), f});
    }
    model.spec = spec;
    model.cost = random_.Real(0.00005, 0.001);
    model.poisoned = options_.poison && j == 0;
    const auto id = farm_->Submit(queue_.now(), spec);
    model.id = *id;
    jobs_.push_back(model);
  }
}

// A batch of events is applied a moment later, all at once.
void Simulation::Touch() {
  if (step_planned_) return;
  step_planned_ = true;
  queue_.After(random_.Duration(0, 0.002), [this] { Step(); });
}

void Simulation::Step() {
  step_planned_ = false;
  if (!farm_) return;
  farm_->Advance(queue_.now());
  FarmOutput output = farm_->TakeOutput();
  for (const Fact& fact : output.facts) {
    journal_.push_back(EncodeFact(fact));
    Trace(fmt::format("{} fact {}", At(), Sha256(journal_.back()).Hex()));
  }
  for (const auto& answer : output.directives) {
    if (auto call = directive_calls_.extract(answer.call)) call.mapped()(answer.directive);
  }
  for (const auto& answer : output.results) {
    if (auto call = results_calls_.extract(answer.call)) call.mapped()(answer);
  }
  for (const FinishedPicture& finished : output.pictures) CheckPicture(finished);
  for (const std::string& line : output.log) Trace(At() + " " + line);
  if (!step_planned_) {
    step_planned_ = true;
    queue_.After(std::max(farm_->Patience(queue_.now()), Instant(1000)), [this] { Step(); });
  }
}

// I2 and I3: whatever came in whatever order, the picture is that of one machine, to the last bit.
void Simulation::CheckPicture(const FinishedPicture& finished) {
  const auto model =
      std::find_if(jobs_.begin(), jobs_.end(), [&](const JobModel& job) { return job.id == finished.job; });
  const uint64_t seed = Hash(model->spec->submission, finished.frame);
  const FramePicture wanted = ReferencePicture(seed, model->spec->frames[finished.frame].spec);
  if (finished.picture.values != wanted.values) Violation("a picture is not the reference");
  if (!model->pictures.insert(finished.frame).second) Violation("a picture came twice");
  const Digest file = Sha256(fmt::format("{} {}", Number(finished.job), finished.frame));
  queue_.After(random_.Duration(0, 0.2),
               [this, job = finished.job, frame = finished.frame, file, epoch = epoch_] {
                 if (!farm_ || epoch != epoch_) return;
                 farm_->PictureWritten(queue_.now(), job, frame, file);
                 Touch();
               });
}

bool Simulation::AllEnded() const {
  return farm_ != nullptr && std::all_of(jobs_.begin(), jobs_.end(), [&](const JobModel& job) {
           const auto status = farm_->Status(queue_.now(), job.id);
           return status && HasEnded(status->state);
         });
}

// I4 for jobs (each is still known) and I5 (each has ended), as it should.
void Simulation::CheckEnd() {
  for (const JobModel& job : jobs_) {
    const auto status = farm_ ? farm_->Status(queue_.now(), job.id) : std::nullopt;
    if (!status) {
      Violation("a job is forgotten");
      continue;
    }
    const bool may_fail = job.poisoned || options_.one_fails_units || options_.one_damages_results;
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
    report_.samples_needed += status->samples_total;
  }
}

SimulationReport Simulation::Run() {
  StartFarm();
  SubmitJobs();
  for (int n = 0; n < options_.workers; ++n) nodes_.emplace_back();
  for (size_t n = 0; n < nodes_.size(); ++n) StartWorker(n);
  PlanFaults();
  const Instant limit = FromSeconds(options_.faults_s + kHealedLimit_s);
  while (!queue_.empty() && queue_.next_at() < limit && !(AllEnded() && Healthy())) {
    queue_.RunNext();
    if (AllEnded() && report_.ended_s == 0) report_.ended_s = Seconds(queue_.now());
  }
  CheckEnd();
  report_.trace = trace_.Finish();
  return report_;
}

}  // namespace tessera
