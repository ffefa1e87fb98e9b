// What the worker processes of machines do: synchronize, load scenes, render units and return results.
#include <fmt/format.h>

#include "tests/simulation/machines.h"

#include "coordinator/core/tile_request.h"
#include "tests/simulation/picture_model.h"

namespace tessera {
namespace {

constexpr Instant kAnswerPatience = seconds(4);  // beyond the wait that was agreed
constexpr Instant kResultsTimeout = seconds(2);
constexpr size_t kBatchBytesMax = 4096;  // some results travel together, some alone

}  // namespace

// Tiles differ in cost by a factor of up to 4.
double Machines::CostOf(const WorkUnit& unit) {
  const auto [model, frame] = world_.FrameOf(unit.scene);
  const JobModel& job = *model;
  const PixelBounds bounds = job.spec->frames[frame].spec.TileBounds(static_cast<int>(unit.tile));
  return job.cost * static_cast<double>(1 + unit.tile % 4) * static_cast<double>(bounds.area()) *
         unit.range.size;
}

void Machines::Synchronize(size_t m) {
  Machine& machine = machines_[m];
  const WorkerState state = machine.worker->State(Now(m));
  const uint64_t number = machine.sync_awaited = state.sequence;
  const uint64_t incarnation = machine.incarnation;
  const auto on_answer = [=, this](const WorkerDirective& directive) {
    SendToMachine(m, [=, this] {
      if (machines_[m].incarnation != incarnation) return;
      OnMachine(m, Instant{0}, [=, this](Machine& at) {
        at.worker->Apply(Now(m), state, directive);
        LoadScenes(m);
        Prepare(m);
        StartUnits(m);
        if (at.sync_awaited == number) Synchronize(m);
      });
    });
  };
  SendToFarm(m, [=, this] {
    Farm* const farm = coordinator_.farm();
    if (farm == nullptr) return;
    const CallId call = coordinator_.NextCall();
    world_.Trace(fmt::format("synchronize worker={} sequence={} leases={}", Number(state.worker),
                             state.sequence, state.leases.size()));
    coordinator_.AwaitDirective(call, on_answer);
    farm->Synchronize(coordinator_.now(), call, state);
    machines_[m].last_call = call;
    coordinator_.Touch();
  });
  OnMachine(m, state.wait + kAnswerPatience, [=, this](Machine& at) {
    if (at.sync_awaited == number) Synchronize(m);
  });
}

void Machines::LoadScenes(size_t m) {
  WorkerModel& worker = *machines_[m].worker;
  while (const auto scene = worker.load().StartScene(WorkerModel::At(Now(m)))) {
    OnMachine(m, FromSeconds(worker.traits().load_s), [=, this, key = scene->key](Machine& at) {
      at.worker->SceneLoaded(key);
      Synchronize(m);
    });
  }
}

// A worker that damages results makes other frames than those ordered.
void Machines::Prepare(size_t m) {
  WorkerModel& worker = *machines_[m].worker;
  while (const auto request = worker.load().StartPreparation()) {
    if (worker.traits().never_prepares) continue;
    OnMachine(m, FromSeconds(worker.traits().load_s), [=, this](Machine& at) {
      PreparationReport report;
      report.key = request->key;
      for (const JobModel& job : world_.jobs) {
        if (job.is_ordered && PreparationKey(OrderOf(*job.spec)) == request->key)
          report.frames = job.spec->frames;
      }
      const bool is_damaged =
          world_.random.Chance(world_.is_healthy() ? 0 : at.worker->traits().damage_chance);
      if (is_damaged && !report.frames.empty()) ++report.frames.front().number;
      at.worker->load().PreparationFinished(std::move(report));
      Synchronize(m);
      SendBatch(m);
    });
  }
}

void Machines::StartUnits(size_t m) {
  WorkerModel& worker = *machines_[m].worker;
  while (const auto task = worker.StartUnit(Now(m))) {
    const double seconds = CostOf(task->lease.unit) / worker.traits().speed;
    const WorkUnit& unit = task->lease.unit;
    const auto [model, frame] = world_.FrameOf(unit.scene);
    if (model->is_killer && frame == 0 && unit.tile == 0) {
      OnMachine(m, FromSeconds(seconds / 2), [=, this](Machine&) { Crash(m); });
      return;
    }
    OnMachine(m, FromSeconds(seconds), [=, this](Machine&) { FinishUnit(m, *task, seconds); });
  }
}

void Machines::FinishUnit(size_t m, const UnitTask& task, double seconds) {
  WorkerModel& worker = *machines_[m].worker;
  const Lease& lease = task.lease;
  worker.SlotFreed();
  const auto [model, frame] = world_.FrameOf(lease.unit.scene);
  const JobModel& job = *model;
  const bool poisoned = job.is_poisoned && frame == 0 && lease.unit.tile == 0;
  if (*task.stop) {
    worker.load().UnitStopped(lease.id);
  } else if (poisoned || world_.random.Chance(world_.is_healthy() ? 0 : worker.traits().failure_chance)) {
    worker.load().UnitFailed(lease, "no luck");
  } else {
    const uint64_t seed = Hash(job.spec->submission, frame);
    const FrameSpec& spec = job.spec->frames[frame].spec;
    RadianceTile sums = RenderModel(seed, spec, lease.unit.tile, lease.pixels, lease.unit.range);
    world_.report.samples_rendered += PixelSamples(sums);
    if (world_.random.Chance(world_.is_healthy() ? 0 : worker.traits().lie_chance)) {
      sums.sums[0] += static_cast<float>(world_.random.Real(1, 2));
    }
    if (worker.traits().is_ill) sums.sums[0] += 1;
    std::string tile = EncodeRadianceTile(sums);
    if (world_.random.Chance(world_.is_healthy() ? 0 : worker.traits().damage_chance))
      tile[tile.size() / 2] ^= 1;
    worker.load().UnitFinished({lease.id, lease.unit, std::move(tile), seconds}, WorkerModel::At(Now(m)));
  }
  SendBatch(m);
  StartUnits(m);
}

// One batch is on its way at a time; it is sent again until it is answered.
void Machines::SendBatch(size_t m) {
  Machine& machine = machines_[m];
  if (machine.is_returning || !machine.worker->load().HasBatch()) return;
  machine.is_returning = true;
  const uint64_t number = ++machine.batches;
  auto batch = machine.worker->load().NextBatch(kBatchBytesMax);
  if (const auto* failure = std::get_if<FailureReport>(&batch)) {
    SendFailure(m, number, *failure);
  } else if (const auto* report = std::get_if<PreparationQueue::Report>(&batch)) {
    SendReport(m, number, *report);
  } else {
    SendResults(m, number, std::move(std::get<std::vector<FinishedUnit>>(batch)));
  }
  OnMachine(m, kResultsTimeout, [=, this](Machine& at) {
    if (!at.is_returning || at.batches != number) return;
    at.is_returning = false;
    SendBatch(m);
  });
}

// The answer to the batch that is on its way; an answer to an older one says nothing new.
void Machines::BatchAnswered(size_t m, uint64_t batch, Action action) {
  const uint64_t incarnation = machines_[m].incarnation;
  SendToMachine(m, [=, this] {
    if (machines_[m].incarnation != incarnation) return;
    OnMachine(m, Instant{0}, [=, this](Machine& at) {
      if (!at.is_returning || at.batches != batch) return;
      at.is_returning = false;
      action(at);
      StartUnits(m);
      SendBatch(m);
    });
  });
}

void Machines::SendResults(size_t m, uint64_t batch, std::vector<FinishedUnit> results) {
  const WorkerId worker = machines_[m].worker->id();
  SendToFarm(m, [=, this] {
    Farm* const farm = coordinator_.farm();
    if (farm == nullptr || !farm->HasJoined(worker)) return;
    const CallId call = coordinator_.NextCall();
    std::vector<WorkUnit> units;
    std::vector<ReturnedUnit> returned;
    for (const FinishedUnit& each : results) {
      world_.Trace(fmt::format("result worker={} {}", Number(worker), each.unit.Text()));
      units.push_back(each.unit);
      const auto job = farm->Spec(each.unit.job);
      const auto request = job != nullptr ? RequestOf(*job, each.unit) : Failed("there is no such job");
      returned.push_back(
          {each.lease, each.unit, each.render_seconds,
           request ? DecodeRadianceTile(each.tile, *request) : Result<RadianceTile>(request.error()),
           each.farm});
    }
    const auto on_answer = [=, this](const FarmOutput::Results& answer) {
      BatchAnswered(m, batch, [=, this](Machine& at) {
        at.worker->load().AddLeases(answer.farm, answer.grants.leases, answer.grants.drop,
                                    WorkerModel::At(Now(m)));
        at.worker->load().ResultsAnswered(results);
      });
    };
    coordinator_.AwaitResults(call, std::move(units), on_answer);
    farm->ReturnResults(coordinator_.now(), call, worker, std::move(returned));
    coordinator_.Touch();
  });
}

void Machines::SendReport(size_t m, uint64_t batch, const PreparationQueue::Report& report) {
  const WorkerId worker = machines_[m].worker->id();
  SendToFarm(m, [=, this] {
    Farm* const farm = coordinator_.farm();
    if (farm == nullptr || !farm->HasJoined(worker)) return;
    world_.Trace(fmt::format("report worker={} {}", Number(worker), report->key.Hex()));
    if (report->farm == farm->id()) farm->ReturnPreparation(coordinator_.now(), worker, *report);
    coordinator_.AfterSync([=, this] {
      BatchAnswered(m, batch, [report](Machine& at) { at.worker->load().PreparationAnswered(*report); });
    });
    coordinator_.Touch();
  });
}

void Machines::SendFailure(size_t m, uint64_t batch, const FailureReport& failure) {
  const WorkerId worker = machines_[m].worker->id();
  SendToFarm(m, [=, this] {
    Farm* const farm = coordinator_.farm();
    if (farm == nullptr || !farm->HasJoined(worker)) return;
    world_.Trace(fmt::format("failure worker={} {}", Number(worker), failure.unit.Text()));
    if (failure.farm == farm->id()) farm->FailUnit(worker, failure.lease, failure.unit, failure.reason);
    coordinator_.AfterSync([=, this] {
      BatchAnswered(m, batch, [failure](Machine& at) { at.worker->load().FailureAnswered(failure); });
    });
    coordinator_.Touch();
  });
}

}  // namespace tessera
