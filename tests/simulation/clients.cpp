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
  for (size_t directory = 0; directory < world_.options.directories(); ++directory) {
    for (int j = 0; j < world_.options.jobs; ++j) MakeJob(j, directory);
  }
  if (world_.options.cancel_one) world_.queue.After(world_.random.Duration(0, 20), [this] { Cancel(0); });
}

// Jobs of a second directory, and some of the first, have the frames of another job: results that were mixed
// up would fit.
std::vector<FrameRequest> Clients::DrawFrames(int number) {
  const auto made = static_cast<int>(world_.jobs.size());
  if (made > number) return world_.jobs[static_cast<size_t>(number)].spec->frames;
  if (made > 0 && world_.random.Chance(0.3)) return world_.jobs.back().spec->frames;
  std::vector<FrameRequest> drawn;
  const int frames = world_.random.Int(1, 2);
  for (int f = 0; f < frames; ++f) drawn.push_back({fmt::format("scene{}.pbrt", f), "", DrawFrame(), f});
  return drawn;
}

void Clients::MakeJob(int number, size_t directory) {
  JobModel model;
  auto spec = std::make_shared<JobSpec>();
  spec->submission = world_.jobs.size() + 1;
  spec->name = fmt::format("job{}", world_.jobs.size());
  spec->package = Sha256(spec->name);
  spec->priority = world_.random.Int(0, 1);
  spec->verify_share = world_.options.verify_share;
  spec->frames = DrawFrames(number);
  for (const FrameRequest& frame : spec->frames) {
    const uint64_t seed = Hash(spec->submission, static_cast<uint64_t>(frame.number));
    model.scenes.push_back(SceneKey(spec->package, frame.scene_file, frame.options, frame.spec));
    model.reference.push_back(ReferenceMerger(seed, frame.spec));
    model.pictures.push_back(model.reference.back().Picture());
    world_.report.samples_needed += model.reference.back().samples_total();
  }
  model.directory = directory;
  model.spec = spec;
  model.cost = world_.random.Real(0.00005, 0.001);
  model.is_poisoned = world_.options.poison && number == 0;
  model.is_killer = world_.options.killer && number == world_.options.jobs - 1;
  model.is_ordered =
      static_cast<double>(Hash(spec->submission, 5) % 100) < 100 * world_.options.ordered_share;
  world_.jobs.push_back(std::move(model));
  world_.queue.After(world_.random.Duration(0, 10), [this, job = world_.jobs.size() - 1] { Submit(job); });
}

FrameSpec Clients::DrawFrame() {
  const auto samples = static_cast<uint32_t>(world_.random.Int(1, 64));
  const int width = world_.random.Int(5, 24);
  const int height = world_.random.Int(5, 24);
  FrameSpec frame = SmallFrame(width, height, 8, samples);
  if (width % 2 == 0) AddModelLayers(frame);
  if (world_.options.noise_threshold == 0 || world_.random.Chance(0.5)) return frame;
  frame.SetNoiseThreshold(world_.options.noise_threshold);
  AddChannel(frame.channels, SamplesChannel(true));
  frame.samples_per_pixel += kDecisionSamplesMin;  // so that there is something to decide
  return frame;
}

// A client submits the same again until it is told that the farm has it.
void Clients::Submit(size_t j) {
  world_.queue.After(kClientRetry, [this, j] { Submit(j); });
  if (world_.jobs[j].is_acknowledged) return;
  world_.Send([this, j] {
    Farm* const farm = coordinator_.farm();
    const bool is_mine = world_.jobs[j].directory == world_.directory;
    if (farm == nullptr || !is_mine || world_.jobs[j].is_acknowledged) return;
    const JobModel& job = world_.jobs[j];
    const auto id =
        job.is_ordered ? farm->Order(coordinator_.now(), std::make_shared<const JobOrder>(OrderOf(*job.spec)))
                       : farm->Submit(coordinator_.now(), job.spec);
    if (!id) return world_.Violation("a job is refused: " + id.error().message);
    coordinator_.AfterSync([this, j, id = *id, restored = world_.restored] {
      world_.Send([this, j, id, restored] {
        if (world_.restored != restored) return;
        world_.Trace(fmt::format("client job={} id={}", world_.jobs[j].spec->name, Number(id)));
        world_.jobs[j].is_acknowledged = true;
      });
    });
    coordinator_.Touch();
  });
}

void Clients::Cancel(size_t j) {
  JobModel& job = world_.jobs[j];
  if (HasEnded(job.told)) return;
  world_.queue.After(kClientRetry, [this, j] { Cancel(j); });
  if (!job.is_acknowledged || job.directory != world_.directory) return;
  job.is_cancelled = true;
  world_.Send([this, j, history = world_.history()] {
    Farm* const farm = coordinator_.farm();
    if (farm == nullptr || world_.history() != history) return;
    if (!farm->Cancel(coordinator_.now(), world_.jobs[j].id)) world_.Violation("a job cannot be cancelled");
    coordinator_.Touch();
  });
}

// An open job that the farm knows; nullptr if the one drawn is not.
JobModel* Clients::SomeOpenJob() {
  JobModel& job = world_.jobs[static_cast<size_t>(world_.random.Int(0, world_.options.jobs - 1))];
  Farm* const farm = coordinator_.farm();
  const bool is_here = job.directory == world_.directory && job.is_acknowledged;
  const auto status = farm != nullptr && is_here ? farm->Status(coordinator_.now(), job.id) : std::nullopt;
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
    if (job.directory != world_.directory) continue;
    are_resumed = are_resumed && job.is_acknowledged;  // a restored farm may have it, paused
    if (farm == nullptr || !job.is_acknowledged) continue;
    const auto status = farm->Status(coordinator_.now(), job.id);
    if (status && !HasEnded(status->state)) (void)farm->SetPaused(coordinator_.now(), job.id, false);
    are_resumed = are_resumed && (!status || !status->paused_by_user);
  }
  if (farm != nullptr) coordinator_.Touch();
  if (!are_resumed) world_.queue.After(kClientRetry, [this] { ResumeAll(); });
}

void Clients::NoteRestored() {
  for (JobModel& job : world_.jobs) {
    if (job.directory != world_.directory) continue;
    job.id = {};
    job.is_acknowledged = false;
    job.told = JobState::kWaiting;
  }
}

bool Clients::have_present_ended() const {
  return std::ranges::all_of(world_.jobs, [&](const JobModel& job) {
    return job.directory != world_.directory || (job.is_acknowledged && HasEnded(job.told));
  });
}

bool Clients::have_all_ended() {
  return coordinator_.farm() != nullptr && std::ranges::all_of(world_.jobs, [](const JobModel& job) {
           return job.is_acknowledged && HasEnded(job.told);
         });
}

}  // namespace tessera
