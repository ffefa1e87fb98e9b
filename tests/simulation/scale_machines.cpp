// The machines of a large farm: processes that render, die and come back.
#include <algorithm>
#include <cmath>

#include "tests/simulation/scale_farm.h"

namespace tessera {

void ScaleFarm::Later(size_t m, Instant delay, std::function<void(Machine&)> action) {
  queue_.After(delay, [this, m, action = std::move(action), incarnation = machines_[m].incarnation] {
    Machine& machine = machines_[m];
    if (machine.incarnation == incarnation && machine.worker) action(machine);
  });
}

void ScaleFarm::Start(size_t m) {
  Machine& machine = machines_[m];
  machine.worker = std::make_unique<WorkerModel>(WorkerId{worker_next_++}, WorkerTraits{});
  ++machine.incarnation;
  machine.running.reset();
  machine.returning = false;
  CallSynchronize(m);
  PlanDeath(m);
}

void ScaleFarm::PlanDeath(size_t m) {
  if (options_.deaths_per_minute <= 0) return;
  const double life_s = -std::log(1 - random_.Real(0, 1)) * 60 / options_.deaths_per_minute;
  Later(m, FromSeconds(life_s), [this, m](Machine&) { Die(m); });
}

void ScaleFarm::Die(size_t m) {
  Machine& machine = machines_[m];
  if (machine.running) lost_ += CostDone(*machine.running);
  machine.running.reset();
  machine.worker.reset();
  machine.died = queue_.now();
  if (!random_.Chance(options_.silent_share)) {
    queue_.After(FromSeconds(options_.latency_s), [this, call = machine.last_call] {
      Post(
          [this, call](Instant now) {
            if (directive_calls_.erase(call) > 0) farm_.Cut(now, call);
          },
          options_.call_cost_s);
    });
  }
  queue_.After(FromSeconds(options_.absence_s), [this, m] {
    absent_ += Seconds(queue_.now() - machines_[m].died) * machines_[m].speed;
    Start(m);
  });
}

void ScaleFarm::CallSynchronize(size_t m) {
  Machine& machine = machines_[m];
  WorkerState state = machine.worker->State(queue_.now());
  const CallId call{call_next_++};
  machine.last_call = call;
  const uint64_t incarnation = machine.incarnation;
  queue_.After(FromSeconds(options_.latency_s), [=, this, state = std::move(state)] {
    directive_calls_[call] = [=, this](const WorkerDirective& directive) {
      Machine& at = machines_[m];
      if (at.incarnation != incarnation || !at.worker) return;
      at.worker->Apply(queue_.now(), state, directive);
      LoadScenes(m);
      StopUnwanted(m);
      StartUnit(m);
      if (state.sequence == at.worker->sequence()) CallSynchronize(m);
    };
    Post([=, this](Instant now) { farm_.Synchronize(now, call, state); }, options_.call_cost_s);
  });
}

void ScaleFarm::LoadScenes(size_t m) {
  const auto now = WorkerModel::At(queue_.now());
  while (const auto scene = machines_[m].worker->load().StartScene(now)) {
    Later(m, FromSeconds(options_.load_s), [=, this, key = scene->key](Machine& at) {
      at.worker->SceneLoaded(key);
      CallSynchronize(m);
    });
  }
}

void ScaleFarm::StartUnit(size_t m) {
  Machine& machine = machines_[m];
  if (machine.running) return;
  auto task = machine.worker->StartUnit(queue_.now());
  if (!task) return;
  const double seconds = CostOf(task->lease.unit) / machine.speed * random_.Real(0.9, 1.1);
  Later(m, FromSeconds(seconds), [this, m, lease = task->lease.id](Machine& at) {
    if (at.running && at.running->task.lease.id == lease) FinishUnit(m);
  });
  machine.running = Running{std::move(*task), queue_.now(), seconds};
}

double ScaleFarm::CostDone(const Running& running) const {
  const double part = running.seconds > 0 ? Seconds(queue_.now() - running.began) / running.seconds : 1;
  return CostOf(running.task.lease.unit) * std::min(part, 1.0);
}

// The rendering of a unit that was dropped ends at once.
void ScaleFarm::StopUnwanted(size_t m) {
  Machine& machine = machines_[m];
  if (!machine.running || !*machine.running->task.stop) return;
  copied_ += CostDone(*machine.running);
  machine.running.reset();
  machine.worker->SlotFreed();
}

void ScaleFarm::FinishUnit(size_t m) {
  Machine& machine = machines_[m];
  const Lease lease = machine.running->task.lease;
  machine.worker->load().UnitFinished({lease.id, lease.unit, "", machine.running->seconds},
                                      WorkerModel::At(queue_.now()));
  machine.running.reset();
  machine.worker->SlotFreed();
  ReturnResults(m);
  StartUnit(m);
}

void ScaleFarm::ReturnResults(size_t m) {
  Machine& machine = machines_[m];
  if (machine.returning || !machine.worker->load().HasBatch()) return;
  machine.returning = true;
  const auto sent = std::get<std::vector<FinishedUnit>>(
      machine.worker->load().NextBatch(static_cast<size_t>(kResultsBatchBytes)));
  const uint64_t incarnation = machine.incarnation;
  const WorkerId worker = machine.worker->id();
  queue_.After(FromSeconds(options_.latency_s), [=, this] {
    const CallId call{call_next_++};
    results_calls_[call] = [=, this](const FarmOutput::Results& results) {
      for (size_t i = 0; i < sent.size(); ++i) {
        if (results.verdicts[i] != Verdict::kAccepted) copied_ += CostOf(sent[i].unit);
      }
      Machine& at = machines_[m];
      if (at.incarnation != incarnation || !at.worker) return;
      at.returning = false;
      at.worker->load().AddLeases(results.farm, results.grants.leases, results.grants.drop,
                                  WorkerModel::At(queue_.now()));
      at.worker->load().ResultsAnswered(sent);
      StopUnwanted(m);
      StartUnit(m);
      ReturnResults(m);
    };
    const auto count = static_cast<double>(sent.size());
    Post(
        [=, this](Instant now) {
          std::vector<ReturnedUnit> units;
          for (const FinishedUnit& unit : sent) {
            const PixelBounds bounds = spec_->frames[0].spec.TileBounds(static_cast<int>(unit.unit.tile));
            RadianceTile tile{bounds, unit.unit.range, {2}, {}};
            tile.sums.resize(static_cast<size_t>(bounds.area()) * 2);
            units.push_back({unit.lease, unit.unit, unit.render_seconds, std::move(tile)});
          }
          farm_.ReturnResults(now, call, worker, std::move(units));
        },
        options_.call_cost_s + count * options_.result_cost_s);
  });
}

}  // namespace tessera
