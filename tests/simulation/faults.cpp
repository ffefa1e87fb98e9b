#include "tests/simulation/faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace tessera {
namespace {

// After which the coordinator's keepalive finds that a worker does not answer.
constexpr Instant kKeepalive = seconds(20);
constexpr Instant kOtherDirectoryPoll = seconds(1);

void Die(const Faults::Parts& on) {
  on.machines.Die(on.machines.Some());
}

void Drain(const Faults::Parts& on) {
  on.machines.Drain(on.machines.Some());
}

void Hang(const Faults::Parts& on) {
  const size_t machine = on.machines.Some();
  const Instant until = on.world.queue.now() + on.world.random.Duration(0, 30);
  on.world.Trace(fmt::format("hang node={}", machine));
  on.machines.HangUntil(machine, std::min(until, FromSeconds(on.world.options.faults_s)));
  // Sometimes the connection breaks though the process lives.
  if (on.world.random.Chance(0.3)) on.coordinator.Cut(on.machines.LastCall(machine));
}

void Partition(const Faults::Parts& on) {
  const size_t machine = on.machines.Some();
  const Instant until = std::min(on.world.queue.now() + on.world.random.Duration(0, 25),
                                 FromSeconds(on.world.options.faults_s));
  const int ways = on.world.random.Int(1, 3);
  on.world.Trace(fmt::format("partition node={} ways={} until_s={:.3f}", machine, ways, Seconds(until)));
  on.machines.CutOffUntil(machine, until, (ways & 1) != 0, (ways & 2) != 0);
  if (until - on.world.queue.now() > kKeepalive) {
    on.world.queue.After(kKeepalive, [&coordinator = on.coordinator, call = on.machines.LastCall(machine)] {
      coordinator.Cut(call);
    });
  }
}

// A machine was asleep and did not notice: its clock goes on, and no other machine's.
void JumpClock(const Faults::Parts& on) {
  const Instant jump = on.world.random.Duration(0, on.world.random.Chance(0.2) ? 1e5 : 60);
  const int machine = on.world.random.Int(-1, on.world.options.workers - 1);
  on.world.Trace(fmt::format("clock machine={} jump_s={:.3f}", machine, Seconds(jump)));
  if (machine < 0) {
    on.coordinator.AdvanceClock(jump);
  } else {
    on.machines.AdvanceClock(static_cast<size_t>(machine), jump);
  }
}

void FillDisk(const Faults::Parts& on) {
  on.world.Trace("disk full");
  on.coordinator.SetDiskFull(true);
  on.world.queue.After(on.world.random.Duration(0, 10), [on] {
    on.world.Trace("disk has room");
    on.coordinator.SetDiskFull(false);
  });
}

// Now, or at some point of the next batch.
void CrashCoordinator(const Faults::Parts& on) {
  const int point = on.world.random.Int(0, 3);
  if (point == 0) return on.coordinator.Crash();
  on.coordinator.CrashAt(static_cast<CoordinatorProcess::CrashPoint>(point));
  if (on.coordinator.farm() != nullptr) on.coordinator.Touch();
}

void Blackout(const Faults::Parts& on) {
  on.world.Trace("blackout");
  on.coordinator.Crash();
  on.machines.KillAll();
}

// Another farm comes to the address that the workers know.
void SwapDirectory(const Faults::Parts& on) {
  on.coordinator.SwapDirectory();
}

// Now and then a backup is made, and now and then one is restored.
void BackUpOrRestore(const Faults::Parts& on) {
  if (on.world.random.Chance(0.5) || !on.coordinator.RestoreBackup()) {
    on.world.Trace("backup");
    on.coordinator.BackUp();
  } else {
    on.clients.NoteRestored();
  }
}

// Power or network of the workers fails, and the coordinator goes on.
void CrashCrowd(const Faults::Parts& on) {
  on.world.Trace("crowd");
  on.machines.CrashAll();
}

void PauseOrResume(const Faults::Parts& on) {
  on.clients.PauseOrResumeSome();
}

void ChangePriority(const Faults::Parts& on) {
  on.clients.ChangeSomePriority();
}

struct FaultKind {
  const char* name;
  double chance;                          // that a simulation has it at all
  double interval_s_min, interval_s_max;  // average time between two of them
  void (*effect)(const Faults::Parts& on);
};

constexpr FaultKind kFaultKinds[] = {
    {"death", 0.5, 2, 30, Die},
    {"drain", 0.3, 5, 30, Drain},
    {"hang", 0.5, 2, 30, Hang},
    {"partition", 0.4, 3, 30, Partition},
    {"clock_jump", 0.3, 3, 40, JumpClock},
    {"full_disk", 0.3, 5, 40, FillDisk},
    {"crash", 0.5, 3, 40, CrashCoordinator},
    {"blackout", 0.15, 10, 40, Blackout},
    {"pause", 0.3, 1, 10, PauseOrResume},
    {"priority", 0.3, 1, 10, ChangePriority},
    {"swap", 0.25, 5, 25, SwapDirectory},
    {"restore", 0.25, 3, 15, BackUpOrRestore},
    {"crowd", 0.2, 3, 30, CrashCrowd},
};

}  // namespace

std::vector<PlannedFault> DrawFaults(uint64_t seed, double until_s) {
  std::vector<PlannedFault> plan;
  for (size_t kind = 0; kind < std::size(kFaultKinds); ++kind) {
    const FaultKind& fault = kFaultKinds[kind];
    Random random(Hash(seed, 78, kind));  // its own stream: a new kind does not change the times of others
    const double interval_s = random.Real(fault.interval_s_min, fault.interval_s_max);
    if (!random.Chance(fault.chance)) continue;
    for (double at_s = random.Real(0, 2 * interval_s); at_s < until_s; at_s += random.Real(0, 2 * interval_s))
      plan.push_back({at_s, kind});
  }
  std::ranges::stable_sort(plan, {}, &PlannedFault::at_s);
  return plan;
}

size_t FaultKindOf(const char* name) {
  const auto found = std::ranges::find(kFaultKinds, std::string_view(name), &FaultKind::name);
  return static_cast<size_t>(found - std::begin(kFaultKinds));
}

std::string FaultsText(const std::vector<PlannedFault>& plan) {
  std::string text;
  for (size_t kind = 0; kind < std::size(kFaultKinds); ++kind) {
    const auto count = std::ranges::count(plan, kind, &PlannedFault::kind);
    if (count > 0) text += fmt::format("{}{}:{}", text.empty() ? "" : ",", kFaultKinds[kind].name, count);
  }
  return text;
}

void Faults::Start() {
  for (const PlannedFault& fault : parts_.world.options.faults) {
    parts_.world.queue.After(FromSeconds(fault.at_s),
                             [this, &kind = kFaultKinds[fault.kind]] { kind.effect(parts_); });
  }
  parts_.world.queue.After(FromSeconds(parts_.world.options.faults_s), [this] { Heal(); });
}

// All is repaired, and a sound machine joins, so that the machines that are left with faults cannot hold up
// the farm; with verification as many as it takes to outvote them.
void Faults::Heal() {
  parts_.world.Trace("heal");
  parts_.coordinator.SetDiskFull(false);
  parts_.coordinator.CrashAt(CoordinatorProcess::CrashPoint::kNone);
  parts_.machines.Heal(parts_.world.options.verify_share > 0 ? 3 : 1);
  parts_.clients.ResumeAll();
  FinishOtherDirectory();
}

// When the jobs of one directory have ended, those of the other are finished.
void Faults::FinishOtherDirectory() {
  if (parts_.world.options.directories() < 2) return;
  parts_.world.queue.After(kOtherDirectoryPoll, [this] {
    if (parts_.coordinator.farm() != nullptr && parts_.clients.have_present_ended() &&
        !parts_.clients.have_all_ended()) {
      parts_.coordinator.SwapDirectory();
      parts_.clients.ResumeAll();
    }
    FinishOtherDirectory();
  });
}

}  // namespace tessera
