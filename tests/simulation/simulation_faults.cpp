// What breaks in a simulation, and when it heals.
#include <fmt/format.h>

#include <algorithm>

#include "tests/simulation/simulation.h"

namespace tessera {
namespace {

constexpr Instant kDrainPatience = seconds(8);
constexpr Instant kDrainLook = milliseconds(100);
// After which the coordinator's keepalive finds that nobody answers.
constexpr Instant kKeepalive = seconds(20);

}  // namespace

void Simulation::Repeat(double interval_s, std::function<void()> fault) {
  if (interval_s <= 0) return;
  queue_.After(random_.Duration(0, 2 * interval_s), [=, this] {
    if (Healthy()) return;
    fault();
    Repeat(interval_s, fault);
  });
}

void Simulation::PlanFaults() {
  Repeat(options_.death_interval_s, [this] { Die(SomeNode()); });
  Repeat(options_.drain_interval_s, [this] { Drain(SomeNode()); });
  Repeat(options_.hang_interval_s, [this] { Hang(SomeNode()); });
  Repeat(options_.partition_interval_s, [this] { Partition(SomeNode()); });
  Repeat(options_.clock_jump_interval_s, [this] { JumpClock(); });
  Repeat(options_.full_disk_interval_s, [this] { FillDisk(); });
  Repeat(options_.blackout_interval_s, [this] { Blackout(); });
  Repeat(options_.crash_interval_s, [this] {
    crash_point_ = random_.Int(0, 3);
    if (crash_point_ == 0) {
      CrashFarm();
    } else if (farm_) {
      Touch();
    }
  });
  Repeat(options_.pause_interval_s, [this] { WishPause(); });
  Repeat(options_.priority_interval_s, [this] { WishPriority(); });
  queue_.After(FromSeconds(options_.faults_s), [this] { Heal(); });
}

// All is repaired, and a sound machine joins, so that no fault of the others can hold up the farm; and as
// many as it takes to agree on what others dispute.
void Simulation::Heal() {
  Trace("heal");
  SetDiskFull(false);
  crash_point_ = 0;
  for (Node& node : nodes_) node.hung_until = node.deaf_until = node.mute_until = queue_.now();
  for (int n = options_.verify_share > 0 ? 3 : 1; n > 0; --n) {
    nodes_.emplace_back();
    StartWorker(nodes_.size() - 1);
  }
  ResumeAll();
}

// The process is killed, or says goodbye first.
void Simulation::Die(size_t n) {
  Node& node = nodes_[n];
  if (!node.worker) return;
  Trace(fmt::format("die node={}", n));
  if (random_.Chance(0.3)) {
    WorkerState goodbye = node.worker->State(NodeNow(n));
    goodbye.leaving = true;
    SendToFarm(n, [this, goodbye] {
      if (!farm_) return;
      farm_->Synchronize(FarmNow(), CallId{call_next_++}, goodbye);
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

// The process is asked to end: it returns what waits, ends what runs, and goes.
void Simulation::Drain(size_t n) {
  if (!nodes_[n].worker) return;
  OnNode(n, Instant{0}, [this, n](Node& node) {
    Trace(fmt::format("drain node={}", n));
    node.worker->load().Drain();
    CallSynchronize(n);
    AwaitDrained(n, queue_.now() + kDrainPatience);
  });
}

void Simulation::AwaitDrained(size_t n, Instant until) {
  OnNode(n, kDrainLook, [=, this](Node& node) {
    if (node.worker->load().IsIdle() || queue_.now() >= until) {
      Die(n);
    } else {
      AwaitDrained(n, until);
    }
  });
}

// Stopped for a while; sometimes its connection breaks though it lives.
void Simulation::Hang(size_t n) {
  Trace(fmt::format("hang node={}", n));
  const Instant until = queue_.now() + random_.Duration(0, 30);
  nodes_[n].hung_until = std::min(until, FromSeconds(options_.faults_s));
  if (random_.Chance(0.3)) Cut(nodes_[n].last_call);
}

void Simulation::Partition(size_t n) {
  const Instant until = std::min(queue_.now() + random_.Duration(0, 25), FromSeconds(options_.faults_s));
  const int ways = random_.Int(1, 3);
  Trace(fmt::format("partition node={} ways={} until_s={:.3f}", n, ways, Seconds(until)));
  if ((ways & 1) != 0) nodes_[n].deaf_until = until;
  if ((ways & 2) != 0) nodes_[n].mute_until = until;
  if (until - queue_.now() > kKeepalive) {
    queue_.After(kKeepalive, [this, call = nodes_[n].last_call] { Cut(call); });
  }
}

// A machine was asleep and did not notice: its clock goes on, and nobody else's.
void Simulation::JumpClock() {
  const Instant jump = random_.Duration(0, random_.Chance(0.2) ? 1e5 : 60);
  const int machine = random_.Int(-1, options_.workers - 1);
  Trace(fmt::format("clock machine={} jump_s={:.3f}", machine, Seconds(jump)));
  (machine < 0 ? farm_clock_ : nodes_[static_cast<size_t>(machine)].clock) += jump;
}

void Simulation::FillDisk() {
  Trace("disk full");
  SetDiskFull(true);
  queue_.After(random_.Duration(0, 10), [this] {
    Trace("disk has room");
    SetDiskFull(false);
  });
}

void Simulation::SetDiskFull(bool full) {
  disk_full_ = full;
  journal_.set_full(full);
  spool_.set_full(full);
}

void Simulation::Blackout() {
  Trace("blackout");
  CrashFarm();
  for (size_t n = 0; n < nodes_.size(); ++n) {
    if (!nodes_[n].worker) continue;
    nodes_[n].worker.reset();
    ++nodes_[n].incarnation;
    queue_.After(random_.Duration(0, 10), [this, n] {
      if (!nodes_[n].worker) StartWorker(n);
    });
  }
}

// The farm learns that the other end of a waiting call is gone.
void Simulation::Cut(CallId call) {
  queue_.After(random_.Duration(0, 0.1), [this, call] {
    if (!farm_ || directive_calls_.erase(call) == 0) return;
    Trace(fmt::format("cut call={}", static_cast<uint64_t>(call)));
    farm_->Cut(FarmNow(), call);
    Touch();
  });
}

}  // namespace tessera
