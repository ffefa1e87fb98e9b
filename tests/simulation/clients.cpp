#include "tests/simulation/clients.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/film/adaptive.h"
#include "tests/simulation/picture_model.h"

namespace tessera {
namespace {

constexpr Instant kClientRetry = seconds(3);

}  // namespace

void Clients::Start() {
  for (int j = 0; j < world_.options.jobs; ++j) MakeJob(j);
  if (world_.options.cancel_one) world_.queue.After(world_.random.Duration(0, 20), [this] { Cancel(0); });
}

void Clients::MakeJob(int number) {
  JobModel model;
  auto spec = std::make_shared<JobSpec>();
  spec->submission = static_cast<uint64_t>(number) + 1;
  spec->name = fmt::format("job{}", number);
  spec->priority = world_.random.Int(0, 1);
  spec->verify_share = world_.options.verify_share;
  const int frames = world_.random.Int(1, 2);
  for (int f = 0; f < frames; ++f) {
    spec->frames.push_back({fmt::format("scene{}.pbrt", f), "", DrawFrame(), f});
    const uint64_t seed = Hash(spec->submission, static_cast<uint64_t>(f));
    model.reference.push_back(ReferenceMerger(seed, spec->frames.back().spec));
    model.pictures.push_back(model.reference.back().Picture());
    world_.report.samples_needed += model.reference.back().samples_total();
  }
  model.spec = spec;
  model.cost = world_.random.Real(0.00005, 0.001);
  model.is_poisoned = world_.options.poison && number == 0;
  world_.jobs.push_back(std::move(model));
  world_.queue.After(world_.random.Duration(0, 10), [this, job = world_.jobs.size() - 1] { Submit(job); });
}

FrameSpec Clients::DrawFrame() {
  const auto samples = static_cast<uint32_t>(world_.random.Int(1, 64));
  const int width = world_.random.Int(5, 24);
  const int height = world_.random.Int(5, 24);
  FrameSpec frame = SmallFrame(width, height, 8, samples);
  if (world_.options.noise_threshold == 0 || world_.random.Chance(0.5)) return frame;
  frame.SetNoiseThreshold(world_.options.noise_threshold);
  AddChannel(frame.channels, SamplesChannel(true));
  frame.samples_per_pixel += kDecisionSamplesMin;  // so that there is something to decide
  return frame;
}

// A client submits the same again until it is told that the farm has it.
void Clients::Submit(size_t j) {
  if (world_.jobs[j].is_acknowledged) return;
  world_.Send([this, j] {
    Farm* const farm = coordinator_.farm();
    if (farm == nullptr || world_.jobs[j].is_acknowledged) return;
    const auto id = farm->Submit(coordinator_.now(), world_.jobs[j].spec);
    if (!id) return world_.Violation("a job is refused: " + id.error().message);
    coordinator_.AfterSync([this, j, id = *id] {
      world_.Send([this, j, id] {
        world_.Trace(fmt::format("client job={} id={}", world_.jobs[j].spec->name, Number(id)));
        world_.jobs[j].is_acknowledged = true;
      });
    });
    coordinator_.Touch();
  });
  world_.queue.After(kClientRetry, [this, j] { Submit(j); });
}

void Clients::Cancel(size_t j) {
  JobModel& job = world_.jobs[j];
  if (HasEnded(job.told)) return;
  world_.queue.After(kClientRetry, [this, j] { Cancel(j); });
  if (!job.is_acknowledged) return;
  job.is_cancelled = true;
  world_.Send([this, j] {
    Farm* const farm = coordinator_.farm();
    if (farm == nullptr) return;
    if (!farm->Cancel(coordinator_.now(), world_.jobs[j].id)) world_.Violation("a job cannot be cancelled");
    coordinator_.Touch();
  });
}

// An open job that the farm knows; nullptr if the one drawn is not.
JobModel* Clients::SomeOpenJob() {
  JobModel& job = world_.jobs[static_cast<size_t>(world_.random.Int(0, world_.options.jobs - 1))];
  Farm* const farm = coordinator_.farm();
  const auto status =
      farm != nullptr && job.is_acknowledged ? farm->Status(coordinator_.now(), job.id) : std::nullopt;
  return status && !HasEnded(status->state) ? &job : nullptr;
}

void Clients::PauseOrResumeSome() {
  const bool paused = world_.random.Chance(0.5);
  const JobModel* const job = SomeOpenJob();
  if (job == nullptr) return;
  if (!coordinator_.farm()->SetPaused(coordinator_.now(), job->id, paused))
    world_.Violation("a job cannot be paused");
  coordinator_.Touch();
}

void Clients::ChangeSomePriority() {
  const int priority = world_.random.Int(-1, 2);
  const JobModel* const job = SomeOpenJob();
  if (job == nullptr) return;
  if (!coordinator_.farm()->SetPriority(coordinator_.now(), job->id, priority))
    world_.Violation("a priority cannot be changed");
  coordinator_.Touch();
}

void Clients::ResumeAll() {
  Farm* const farm = coordinator_.farm();
  bool are_resumed = farm != nullptr;
  for (const JobModel& job : world_.jobs) {
    if (farm == nullptr || !job.is_acknowledged) continue;
    const auto status = farm->Status(coordinator_.now(), job.id);
    if (status && !HasEnded(status->state)) (void)farm->SetPaused(coordinator_.now(), job.id, false);
    are_resumed = are_resumed && (!status || !status->paused_by_user);
  }
  if (farm != nullptr) coordinator_.Touch();
  if (!are_resumed) world_.queue.After(kClientRetry, [this] { ResumeAll(); });
}

bool Clients::have_all_ended() {
  return coordinator_.farm() != nullptr && std::ranges::all_of(world_.jobs, [](const JobModel& job) {
           return job.is_acknowledged && HasEnded(job.told);
         });
}

}  // namespace tessera
