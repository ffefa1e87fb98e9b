// The workers' side of the simulation and its network.
#include <fmt/format.h>

#include <algorithm>

#include "tests/simulation/simulation.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kWait{2000};
constexpr Instant kSynchronizeTimeout = std::chrono::seconds(6);
constexpr Instant kResultsTimeout = std::chrono::seconds(2);

}  // namespace

const Simulation::JobModel& Simulation::ModelOf(JobId id) const {
  return *std::find_if(jobs_.begin(), jobs_.end(), [&](const JobModel& job) { return job.id == id; });
}

// Tiles differ in cost by a factor of up to 4.
double Simulation::CostOf(const WorkUnit& unit) const {
  const JobModel& job = ModelOf(unit.job);
  const PixelBounds bounds = job.spec->frames[unit.frame].spec.TileBounds(static_cast<int>(unit.tile));
  return job.cost * static_cast<double>(1 + unit.tile % 4) * static_cast<double>(bounds.area()) *
         unit.range.size;
}

// Loses, repeats and delays, until the farm heals.
void Simulation::Send(Deliver deliver) {
  const bool healthy = Healthy();
  if (!healthy && random_.Chance(options_.loss)) return;
  const double delay_max_s = healthy ? 0.002 : options_.delay_max_s;
  if (!healthy && random_.Chance(options_.duplication))
    queue_.After(random_.Duration(0, delay_max_s * 4), deliver);
  queue_.After(random_.Duration(0, delay_max_s), std::move(deliver));
}

void Simulation::StartWorker(size_t n) {
  Node& node = nodes_[n];
  WorkerTraits traits;
  traits.slots = random_.Int(1, 3);
  traits.speed = random_.Chance(0.2) ? random_.Real(0.1, 0.3) : random_.Real(0.7, 1.3);
  traits.load_s = random_.Real(0.01, 2);
  if (n == 1 && options_.one_fails_units) traits.failure_chance = 0.3;
  if (n == 2 && options_.one_damages_results) traits.damage_chance = 0.5;
  node.worker = std::make_unique<WorkerModel>(WorkerId{worker_next_++}, traits);
  ++node.incarnation;
  node.hung_until = {};
  node.unanswered.clear();
  CallSynchronize(n);
}

void Simulation::PlanFaults() {
  const auto repeat = [this](double interval_s, auto&& self, auto fault) -> void {
    if (interval_s <= 0) return;
    queue_.After(random_.Duration(0, 2 * interval_s), [=, this] {
      if (Healthy()) return;
      fault();
      self(interval_s, self, fault);
    });
  };
  const auto some = [this] { return static_cast<size_t>(random_.Int(0, options_.workers - 1)); };
  repeat(options_.death_interval_s, repeat, [=, this] { Die(some()); });
  repeat(options_.hang_interval_s, repeat, [=, this] { Hang(some()); });
  repeat(options_.crash_interval_s, repeat, [=, this] {
    if (farm_) CrashFarm();
  });
  if (options_.cancel_one) {
    queue_.After(random_.Duration(0, 20), [this] {
      if (!farm_ || jobs_.empty()) return;
      jobs_[0].cancelled = true;
      if (!farm_->Cancel(queue_.now(), jobs_[0].id)) Violation("a job cannot be cancelled");
      Touch();
    });
  }
  // Healing: a sound machine joins, so that no fault of the others can hold up the farm.
  queue_.After(FromSeconds(options_.faults_s), [this] {
    nodes_.emplace_back();
    StartWorker(nodes_.size() - 1);
  });
}

// The process is killed, or says goodbye first.
void Simulation::Die(size_t n) {
  Node& node = nodes_[n];
  if (!node.worker) return;
  Trace(fmt::format("{} die {}", At(), Number(node.worker->id())));
  if (random_.Chance(0.3)) {
    WorkerState goodbye = node.worker->State(queue_.now(), {});
    goodbye.leaving = true;
    Send([this, goodbye] {
      if (!farm_) return;
      farm_->Synchronize(queue_.now(), CallId{call_next_++}, goodbye);
      Touch();
    });
  }
  if (random_.Chance(0.7)) Cut(node.last_call);
  node.worker.reset();
  ++node.incarnation;
  queue_.After(random_.Duration(0, 10), [this, n] {
    if (!nodes_[n].worker) StartWorker(n);
  });
}

// Stopped for a while; sometimes its connection breaks though it lives.
void Simulation::Hang(size_t n) {
  nodes_[n].hung_until = queue_.now() + random_.Duration(0, 30);
  if (Seconds(nodes_[n].hung_until) > options_.faults_s)
    nodes_[n].hung_until = FromSeconds(options_.faults_s);
  if (random_.Chance(0.3)) Cut(nodes_[n].last_call);
}

// The farm learns that the other end of a waiting call is gone.
void Simulation::Cut(CallId call) {
  queue_.After(random_.Duration(0, 0.1), [this, call] {
    if (!farm_ || directive_calls_.erase(call) == 0) return;
    Trace(fmt::format("{} cut {}", At(), static_cast<uint64_t>(call)));
    farm_->Cut(queue_.now(), call);
    Touch();
  });
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
  const WorkerState state = node.worker->State(queue_.now(), kWait);
  const uint64_t number = ++node.sync_awaited;
  const uint64_t incarnation = node.incarnation;
  Send([=, this] {
    if (!farm_) return;
    const CallId call{call_next_++};
    Trace(fmt::format("{} synchronize {} #{}", At(), Number(state.worker), state.sequence));
    directive_calls_[call] = [=, this](const WorkerDirective& directive) {
      Send([=, this] {
        if (nodes_[n].incarnation != incarnation) return;
        OnNode(n, Instant{0}, [=, this](Node& at) {
          TakeDirective(n, directive);
          if (at.sync_awaited == number) CallSynchronize(n);
        });
      });
    };
    farm_->Synchronize(queue_.now(), call, state);
    nodes_[n].last_call = call;
    Touch();
  });
  OnNode(n, kSynchronizeTimeout, [=, this](Node& at) {
    if (at.sync_awaited == number) CallSynchronize(n);
  });
}

void Simulation::TakeDirective(size_t n, const WorkerDirective& directive) {
  Node& node = nodes_[n];
  for (const Lease& lease : directive.leases) {
    Trace(fmt::format("{} lease {} {} {}", At(), Number(node.worker->id()), Number(lease.id),
                      lease.unit.Text()));
  }
  for (const SceneOrder& scene : node.worker->Apply(queue_.now(), directive)) {
    OnNode(n, FromSeconds(node.worker->traits().load_s), [=, this, key = scene.key](Node& at) {
      at.worker->SceneLoaded(key);
      CallSynchronize(n);
    });
  }
  std::erase_if(node.unanswered, [&](const auto& each) { return !node.worker->Holds(each.first); });
  StartUnits(n);
}

void Simulation::StartUnits(size_t n) {
  Node& node = nodes_[n];
  while (const auto lease = node.worker->Start(queue_.now())) {
    const double seconds = CostOf(lease->unit) / node.worker->traits().speed;
    OnNode(n, FromSeconds(seconds), [=, this](Node&) { FinishUnit(n, *lease, seconds); });
  }
}

void Simulation::FinishUnit(size_t n, const Lease& lease, double seconds) {
  Node& node = nodes_[n];
  if (!node.worker->Rendered(queue_.now(), lease.id)) {
    StartUnits(n);
    return;
  }
  const WorkUnit unit = lease.unit;
  report_.samples_rendered += static_cast<uint64_t>(lease.bounds.area()) * unit.range.size;
  const bool poisoned = ModelOf(unit.job).poisoned && unit.frame == 0 && unit.tile == 0;
  if (poisoned || random_.Chance(Healthy() ? 0 : node.worker->traits().failure_chance)) {
    node.worker->Forget(lease.id);
    Send([=, this, worker = node.worker->id()] {
      if (!farm_) return;
      farm_->FailUnit(queue_.now(), worker, lease.id, unit, "no luck");
      Touch();
    });
    StartUnits(n);
    return;
  }
  const uint64_t seed = Hash(ModelOf(unit.job).spec->submission, unit.frame);
  ReturnedUnit result{lease.id, unit, seconds, RenderModel(seed, lease.bounds, unit.range)};
  if (random_.Chance(Healthy() ? 0 : node.worker->traits().damage_chance)) {
    result.tile = random_.Chance(0.5) ? Result<RadianceTile>(Failed("damaged"))
                                      : RenderModel(seed, lease.bounds, unit.range.Sibling());
  }
  node.unanswered[lease.id] = std::move(result);
  CallReturnResults(n, lease.id);
  StartUnits(n);
}

void Simulation::CallReturnResults(size_t n, LeaseId lease) {
  Node& node = nodes_[n];
  const auto unanswered = node.unanswered.find(lease);
  if (unanswered == node.unanswered.end()) return;
  const uint64_t incarnation = node.incarnation;
  Send([=, this, worker = node.worker->id(), unit = unanswered->second] {
    if (!farm_) return;
    const CallId call{call_next_++};
    Trace(fmt::format("{} result {} {}", At(), Number(worker), unit.unit.Text()));
    results_calls_[call] = [=, this](const FarmOutput::Results& results) {
      ++report_.results;
      if (results.verdicts[0] == Verdict::kRefused) ++report_.refused;
      if (results.verdicts[0] == Verdict::kDuplicate) ++report_.duplicates;
      Send([=, this] {
        if (nodes_[n].incarnation != incarnation) return;
        OnNode(n, Instant{0}, [=, this](Node& at) {
          at.unanswered.erase(lease);
          at.worker->Forget(lease);
          TakeDirective(n, {{}, results.grants.leases, results.grants.drop, {}, {}});
        });
      });
    };
    farm_->ReturnResults(queue_.now(), call, worker, {unit});
    Touch();
  });
  OnNode(n, kResultsTimeout, [=, this](Node&) { CallReturnResults(n, lease); });
}

}  // namespace tessera
