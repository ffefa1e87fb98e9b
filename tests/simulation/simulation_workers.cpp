// The workers' side of a simulation and its network.
#include <fmt/format.h>

#include <algorithm>

#include "tests/simulation/simulation.h"

namespace tessera {
namespace {

constexpr Instant kAnswerPatience = seconds(4);  // beyond the wait that was agreed
constexpr Instant kResultsTimeout = seconds(2);
constexpr size_t kParcelBytesMax = 4096;  // some results together, some alone

}  // namespace

// Tiles differ in cost by a factor of up to 4.
double Simulation::CostOf(const WorkUnit& unit) {
  const JobModel& job = *ModelOf(unit.job);
  const PixelBounds bounds = job.spec->frames[unit.frame].spec.TileBounds(static_cast<int>(unit.tile));
  return job.cost * static_cast<double>(1 + unit.tile % 4) * static_cast<double>(bounds.area()) *
         unit.range.size;
}

// Loses, repeats, reorders and delays, until the farm heals.
void Simulation::Send(Deliver deliver) {
  const bool healthy = Healthy();
  if (!healthy && random_.Chance(options_.loss)) return;
  const double delay_max_s = healthy ? 0.002 : options_.delay_max_s;
  if (!healthy && random_.Chance(options_.duplication))
    queue_.After(random_.Duration(0, delay_max_s * 4), deliver);
  const bool late = !healthy && random_.Chance(options_.reordering);
  queue_.After(random_.Duration(0, late ? 5 : delay_max_s), std::move(deliver));
}

void Simulation::SendToFarm(size_t n, Deliver deliver) {
  if (nodes_[n].mute_until <= queue_.now()) Send(std::move(deliver));
}

void Simulation::SendToNode(size_t n, Deliver deliver) {
  if (nodes_[n].deaf_until <= queue_.now()) Send(std::move(deliver));
}

void Simulation::StartWorker(size_t n) {
  Node& node = nodes_[n];
  WorkerTraits traits;
  traits.slots = random_.Int(1, 3);
  traits.speed = node.speed;
  traits.load_s = random_.Real(0.01, 2);
  if (n == 1 && options_.one_fails_units) traits.failure_chance = 0.3;
  if (n == 2 && options_.one_damages_results) traits.damage_chance = 0.5;
  if (n == 0 && options_.one_lies) traits.lie_chance = 0.3;
  node.worker = std::make_unique<WorkerModel>(WorkerId{worker_next_++}, traits);
  ++node.incarnation;
  node.hung_until = {};
  node.returning = false;
  Trace(fmt::format("process node={} worker={}", n, Number(node.worker->id())));
  CallSynchronize(n);
}

void Simulation::OnNode(size_t n, Instant delay, std::function<void(Node&)> action) {
  queue_.After(delay, [this, n, action = std::move(action), incarnation = nodes_[n].incarnation] {
    Node& node = nodes_[n];
    if (node.incarnation != incarnation || !node.worker) return;
    if (node.hung_until > queue_.now()) {
      OnNode(n, node.hung_until - queue_.now(), action);
    } else {
      action(node);
    }
  });
}

void Simulation::CallSynchronize(size_t n) {
  Node& node = nodes_[n];
  const WorkerState state = node.worker->State(NodeNow(n));
  const uint64_t number = node.sync_awaited = state.sequence;
  const uint64_t incarnation = node.incarnation;
  const auto on_answer = [=, this](const WorkerDirective& directive) {
    SendToNode(n, [=, this] {
      if (nodes_[n].incarnation != incarnation) return;
      OnNode(n, Instant{0}, [=, this](Node& at) {
        at.worker->Apply(NodeNow(n), state, directive);
        LoadScenes(n);
        StartUnits(n);
        if (at.sync_awaited == number) CallSynchronize(n);
      });
    });
  };
  SendToFarm(n, [=, this] {
    if (!farm_) return;
    const CallId call{call_next_++};
    Trace(fmt::format("synchronize worker={} sequence={} leases={}", Number(state.worker), state.sequence,
                      state.leases.size()));
    directive_calls_[call] = on_answer;
    farm_->Synchronize(FarmNow(), call, state);
    nodes_[n].last_call = call;
    Touch();
  });
  OnNode(n, state.wait + kAnswerPatience, [=, this](Node& at) {
    if (at.sync_awaited == number) CallSynchronize(n);
  });
}

void Simulation::LoadScenes(size_t n) {
  WorkerModel& worker = *nodes_[n].worker;
  while (const auto scene = worker.load().StartScene(WorkerModel::At(NodeNow(n)))) {
    OnNode(n, FromSeconds(worker.traits().load_s), [=, this, key = scene->key](Node& at) {
      at.worker->SceneLoaded(key);
      CallSynchronize(n);
    });
  }
}

void Simulation::StartUnits(size_t n) {
  WorkerModel& worker = *nodes_[n].worker;
  while (const auto task = worker.StartUnit(NodeNow(n))) {
    const double seconds = CostOf(task->lease.unit) / worker.traits().speed;
    OnNode(n, FromSeconds(seconds), [=, this](Node&) { FinishUnit(n, *task, seconds); });
  }
}

void Simulation::FinishUnit(size_t n, const UnitTask& task, double seconds) {
  WorkerModel& worker = *nodes_[n].worker;
  const Lease& lease = task.lease;
  worker.SlotFreed();
  const JobModel& job = *ModelOf(lease.unit.job);
  const bool poisoned = job.poisoned && lease.unit.frame == 0 && lease.unit.tile == 0;
  if (*task.stop) {
    worker.load().UnitStopped(lease.id);
  } else if (poisoned || random_.Chance(Healthy() ? 0 : worker.traits().failure_chance)) {
    worker.load().UnitFailed(lease, "no luck");
  } else {
    const uint64_t seed = Hash(job.spec->submission, lease.unit.frame);
    const FrameSpec& spec = job.spec->frames[lease.unit.frame].spec;
    RadianceTile sums = RenderModel(seed, spec, lease.unit.tile, lease.pixels, lease.unit.range);
    report_.samples_rendered += PixelSamples(sums);
    if (random_.Chance(Healthy() ? 0 : worker.traits().lie_chance)) {
      sums.sums[0] += static_cast<float>(random_.Real(1, 2));
    }
    std::string tile = EncodeRadianceTile(sums);
    if (random_.Chance(Healthy() ? 0 : worker.traits().damage_chance)) tile[tile.size() / 2] ^= 1;
    worker.load().UnitFinished({lease.id, lease.unit, std::move(tile), seconds}, WorkerModel::At(NodeNow(n)));
  }
  SendParcel(n);
  StartUnits(n);
}

// One parcel is on its way at a time; it is sent again until it is answered.
void Simulation::SendParcel(size_t n) {
  Node& node = nodes_[n];
  if (node.returning || !node.worker->load().HasParcel()) return;
  node.returning = true;
  const uint64_t number = ++node.parcels;
  auto parcel = node.worker->load().NextParcel(kParcelBytesMax);
  if (const auto* failure = std::get_if<FailureReport>(&parcel)) {
    SendFailure(n, number, *failure);
  } else {
    SendResults(n, number, std::move(std::get<std::vector<FinishedUnit>>(parcel)));
  }
  OnNode(n, kResultsTimeout, [=, this](Node& at) {
    if (!at.returning || at.parcels != number) return;
    at.returning = false;
    SendParcel(n);
  });
}

// The answer to the parcel that is on its way; an answer to an older one says nothing new.
void Simulation::ParcelAnswered(size_t n, uint64_t parcel, std::function<void(Node&)> action) {
  const uint64_t incarnation = nodes_[n].incarnation;
  SendToNode(n, [=, this] {
    if (nodes_[n].incarnation != incarnation) return;
    OnNode(n, Instant{0}, [=, this](Node& at) {
      if (!at.returning || at.parcels != parcel) return;
      at.returning = false;
      action(at);
      StartUnits(n);
      SendParcel(n);
    });
  });
}

void Simulation::SendResults(size_t n, uint64_t parcel, std::vector<FinishedUnit> results) {
  const WorkerId worker = nodes_[n].worker->id();
  SendToFarm(n, [=, this] {
    if (!farm_) return;
    const CallId call{call_next_++};
    std::vector<WorkUnit> units;
    std::vector<ReturnedUnit> returned;
    for (const FinishedUnit& each : results) {
      Trace(fmt::format("result worker={} {}", Number(worker), each.unit.Text()));
      units.push_back(each.unit);
      returned.push_back({each.lease, each.unit, each.render_seconds, DecodeRadianceTile(each.tile)});
    }
    results_calls_[call] = {std::move(units), [=, this](const FarmOutput::Results& answer) {
                              ParcelAnswered(n, parcel, [=, this](Node& at) {
                                at.worker->load().AddLeases(answer.grants.leases, answer.grants.drop,
                                                            WorkerModel::At(NodeNow(n)));
                                at.worker->load().ResultsAnswered(results);
                              });
                            }};
    farm_->ReturnResults(FarmNow(), call, worker, std::move(returned));
    Touch();
  });
}

void Simulation::SendFailure(size_t n, uint64_t parcel, const FailureReport& failure) {
  const WorkerId worker = nodes_[n].worker->id();
  SendToFarm(n, [=, this] {
    if (!farm_) return;
    Trace(fmt::format("failure worker={} {}", Number(worker), failure.unit.Text()));
    farm_->FailUnit(FarmNow(), worker, failure.lease, failure.unit, failure.reason);
    after_sync_.push_back(
        [=, this] { ParcelAnswered(n, parcel, [](Node& at) { at.worker->load().FailureAnswered(); }); });
    Touch();
  });
}

}  // namespace tessera
