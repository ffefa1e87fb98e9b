// Processes of machines: how they start, end, hang and are cut off. What they do meanwhile: machine_work.cpp.
#include "tests/simulation/machines.h"

#include <fmt/format.h>

#include <algorithm>

namespace tessera {
namespace {

constexpr Instant kDrainPatience = seconds(8);
constexpr Instant kDrainPoll = milliseconds(100);

}  // namespace

void Machines::Start() {
  const SimulationOptions& options = world_.options;
  for (int m = 0; m < options.workers; ++m) {
    Machine& machine = machines_.emplace_back();
    machine.speed = world_.random.Real(0.7, 1.3) * (world_.random.Chance(options.slow_share) ? 0.1 : 1);
    machine.clock = world_.random.Duration(0, 1e6);
  }
  for (size_t m = 0; m < machines_.size(); ++m) StartWorker(m);
}

void Machines::SendToFarm(size_t m, World::Deliver deliver) {
  if (machines_[m].mute_until <= world_.queue.now()) world_.Send(std::move(deliver));
}

void Machines::SendToMachine(size_t m, World::Deliver deliver) {
  if (machines_[m].deaf_until <= world_.queue.now()) world_.Send(std::move(deliver));
}

void Machines::StartWorker(size_t m) {
  const SimulationOptions& options = world_.options;
  Machine& machine = machines_[m];
  WorkerTraits traits;
  traits.slots = world_.random.Int(1, 3);
  traits.speed = machine.speed;
  traits.machine = m / 2 + 1;  // two workers on each
  traits.is_ill = options.ill_machine && traits.machine == 1;
  traits.load_s = world_.random.Real(0.01, 2);
  if (m == 1 && options.one_fails_units) traits.failure_chance = 0.3;
  if (m == 2 && options.one_damages_results) traits.damage_chance = 0.5;
  traits.never_prepares = m == 0 && options.one_never_prepares;
  if (m == 0 && options.one_lies) traits.lie_chance = 0.3;
  const WorkerId id{worker_next_++};
  if (traits.failure_chance + traits.damage_chance + traits.lie_chance > 0 || traits.is_ill)
    world_.faulty_workers.insert(id);
  machine.worker = std::make_unique<WorkerModel>(id, traits);
  ++machine.incarnation;
  machine.hung_until = {};
  machine.is_returning = false;
  world_.Trace(fmt::format("process node={} worker={}", m, Number(id)));
  Synchronize(m);
}

void Machines::OnMachine(size_t m, Instant delay, Action action) {
  world_.queue.After(delay, [this, m, action = std::move(action), incarnation = machines_[m].incarnation] {
    Machine& machine = machines_[m];
    if (machine.incarnation != incarnation || !machine.worker) return;
    if (machine.hung_until > world_.queue.now()) {
      OnMachine(m, machine.hung_until - world_.queue.now(), action);
    } else {
      action(machine);
    }
  });
}

void Machines::RestartLater(size_t m) {
  machines_[m].worker.reset();
  ++machines_[m].incarnation;
  world_.queue.After(world_.random.Duration(0, 10), [this, m] {
    if (!machines_[m].worker) StartWorker(m);
  });
}

void Machines::Die(size_t m) {
  Machine& machine = machines_[m];
  if (!machine.worker) return;
  world_.Trace(fmt::format("die node={}", m));
  ++world_.deaths;
  if (world_.random.Chance(0.3)) {
    WorkerState goodbye = machine.worker->State(Now(m));
    goodbye.leaving = true;
    SendToFarm(m, [this, goodbye] {
      Farm* const farm = coordinator_.farm();
      if (farm == nullptr) return;
      farm->Synchronize(coordinator_.now(), coordinator_.NextCall(), goodbye);
      coordinator_.Touch();
    });
  }
  if (world_.random.Chance(0.7)) coordinator_.Cut(machine.last_call);
  RestartLater(m);
}

void Machines::Crash(size_t m) {
  if (!machines_[m].worker) return;
  world_.Trace(fmt::format("killed node={}", m));
  ++world_.deaths;
  coordinator_.Cut(machines_[m].last_call);
  RestartLater(m);
}

void Machines::Drain(size_t m) {
  if (!machines_[m].worker) return;
  OnMachine(m, Instant{0}, [this, m](Machine& machine) {
    world_.Trace(fmt::format("drain node={}", m));
    machine.worker->load().Drain();
    Synchronize(m);
    AwaitDrained(m, world_.queue.now() + kDrainPatience);
  });
}

void Machines::AwaitDrained(size_t m, Instant until) {
  OnMachine(m, kDrainPoll, [=, this](Machine& machine) {
    if (machine.worker->load().IsIdle() || world_.queue.now() >= until) {
      Die(m);
    } else {
      AwaitDrained(m, until);
    }
  });
}

void Machines::CrashAll() {
  // For the coordinator the death of the only worker that is in contact is that of a single one.
  const auto in_contact = std::ranges::count_if(machines_, [&](const Machine& machine) {
    return machine.worker != nullptr && machine.hung_until <= world_.queue.now();
  });
  if (in_contact <= 1) ++world_.deaths;
  for (size_t m = 0; m < machines_.size(); ++m) {
    if (!machines_[m].worker) continue;
    coordinator_.Cut(machines_[m].last_call);
    RestartLater(m);
  }
}

void Machines::CutOffUntil(size_t m, Instant until, bool receives, bool sends) {
  if (receives) machines_[m].deaf_until = until;
  if (sends) machines_[m].mute_until = until;
}

void Machines::KillAll() {
  for (size_t m = 0; m < machines_.size(); ++m) {
    if (machines_[m].worker) RestartLater(m);
  }
}

void Machines::Heal(int sound_machines) {
  for (Machine& machine : machines_)
    machine.hung_until = machine.deaf_until = machine.mute_until = world_.queue.now();
  for (int n = 0; n < sound_machines; ++n) {
    machines_.emplace_back();
    StartWorker(machines_.size() - 1);
  }
}

}  // namespace tessera
