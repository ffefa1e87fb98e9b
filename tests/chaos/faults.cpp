#include "tests/chaos/faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>

#include "tests/chaos/damage.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;

// One in this many faults is of a kind that has not been injected often enough, though it may be a rare one.
constexpr int kMissingShare = 4;

// A random worker that is not hurt, or -1.
int SomeWorker(const FaultTargets& on) {
  const int worker = on.dice.Below(on.farms.workers());
  return on.farms.IsHurt(worker) ? -1 : worker;
}

// Whether the coordinator of a farm may be hurt: it is not, and no answer is awaited from it.
bool IsWell(const FaultTargets& on, int farm) {
  return !on.farms.IsCoordinatorHurt(farm) && !on.probes.IsWaiting(farm);
}

// A random farm whose coordinator may be hurt, or -1.
int SomeFarm(const FaultTargets& on) {
  const int farm = on.dice.Below(kFarms);
  return IsWell(on, farm) ? farm : -1;
}

bool KillWorker(const FaultTargets& on) {
  const int worker = SomeWorker(on);
  if (worker >= 0) on.farms.KillWorker(worker, on.dice.Between(0, 2000));
  return worker >= 0;
}

bool StopWorker(const FaultTargets& on) {
  const int worker = SomeWorker(on);
  if (worker < 0) return false;
  const bool is_given_up = on.dice.Below(8) == 0;  // longer than a coordinator waits for a worker
  on.farms.StopWorker(worker, is_given_up ? on.dice.Between(11'000, 13'000) : on.dice.Between(50, 3000));
  return true;
}

bool DrainWorker(const FaultTargets& on) {
  const int worker = SomeWorker(on);
  if (worker >= 0) on.farms.DrainWorker(worker, on.dice.Between(500, 2000));
  return worker >= 0;
}

bool KillCoordinator(const FaultTargets& on) {
  const int farm = SomeFarm(on);
  if (farm >= 0) on.farms.KillCoordinator(farm, on.dice.Between(0, 2000));
  return farm >= 0;
}

bool StopCoordinator(const FaultTargets& on) {
  const int farm = SomeFarm(on);
  if (farm >= 0) on.farms.StopCoordinator(farm, on.dice.Between(100, 2000));
  return farm >= 0;
}

// Bits flip while the process that owns the files is away, as it may be writing them.
bool FlipInDataDir(const FaultTargets& on, const char* subfolder) {
  const int farm = SomeFarm(on);
  if (farm < 0) return false;
  on.farms.KillCoordinator(farm, on.dice.Between(0, 1000));
  return FlipBit(on.farms.DataDir(farm) + subfolder, on.dice.engine());
}

bool FlipInPictures(const FaultTargets& on) {
  return FlipInDataDir(on, "/pictures");
}

bool FlipInBlobs(const FaultTargets& on) {
  return FlipInDataDir(on, "/blobs");
}

bool FlipInCache(const FaultTargets& on) {
  const int worker = SomeWorker(on);
  if (worker < 0) return false;
  on.farms.KillWorker(worker, on.dice.Between(0, 1000));
  return FlipBit(on.folder.Cache(worker), on.dice.engine());
}

bool ExchangeAddresses(const FaultTargets& on) {
  if (!IsWell(on, 0) || !IsWell(on, 1)) return false;
  on.farms.ExchangeAddresses();
  return true;
}

bool BackUp(const FaultTargets& on) {
  const int farm = SomeFarm(on);
  if (farm >= 0) on.farms.BackUp(farm);
  return farm >= 0;
}

bool Restore(const FaultTargets& on) {
  const int farm = SomeFarm(on);
  return farm >= 0 && on.farms.Restore(farm);
}

// The coordinator has no descriptors left for connections. A probe asks it when they are closed.
bool ExhaustDescriptors(const FaultTargets& on) {
  const int farm = SomeFarm(on);
  if (farm < 0) return false;
  auto& connections = on.connections.at(static_cast<size_t>(farm));
  if (connections.is_open()) return false;
  connections.Open(on.history.Address(farm), kCoordinatorDescriptors, on.dice.Between(300, 2500));
  return connections.is_open();
}

bool SlowDisks(const FaultTargets& on) {
  const int farm = SomeFarm(on);
  if (farm < 0 || on.slow_disk.is_slow()) return false;
  on.slow_disk.Slow(on.dice.Between(20, 600), on.dice.Between(1000, 4000));
  on.probes.Ask(farm, "while its disk was slow");
  return true;
}

bool StallClients(const FaultTargets& on) {
  const auto finished = on.customers.LastFinished();
  if (!finished || on.stalled.open() > 1 || on.farms.IsCoordinatorHurt(finished->place.farm)) return false;
  on.stalled.Open({on.history.Address(finished->place.farm), std::stoull(finished->id)});
  return true;
}

bool SubmitDeadlyScene(const FaultTargets& on) {
  return on.customers.OrderDeadlyJob(on.dice.Below(kFarms));
}

bool FillDisk(const FaultTargets& on) {
  if (on.filler.is_full()) return false;
  on.filler.Fill(on.dice.Between(500, 4000));
  return true;
}

// What a run must have for a fault. Sanitizers take memory themselves, and load no library before their own.
enum class Needs { kNothing, kSmallDisk, kLargeDisk, kNoSanitizer };

struct FaultKind {
  const char* name;
  const char* effect;  // for --help
  int weight;          // how often it is drawn, relative to the others
  Needs needs;
  bool (*inject)(const FaultTargets& on);  // returns false if it is not possible now
};

constexpr FaultKind kFaultKinds[] = {
    {"worker_kill", "a worker is killed", 280, Needs::kNothing, KillWorker},
    {"worker_stop", "a worker hangs for a while", 280, Needs::kNothing, StopWorker},
    {"worker_drain", "a worker is asked to end", 60, Needs::kNothing, DrainWorker},
    {"coordinator_kill", "a coordinator is killed", 60, Needs::kNothing, KillCoordinator},
    {"coordinator_stop", "a coordinator hangs for a while", 40, Needs::kNothing, StopCoordinator},
    {"picture_flip", "a bit of a finished picture flips", 30, Needs::kNothing, FlipInPictures},
    {"blob_flip", "a bit of a scene file flips at a coordinator", 30, Needs::kNothing, FlipInBlobs},
    {"cache_flip", "a bit of a scene file flips in a worker's cache", 60, Needs::kNothing, FlipInCache},
    {"exchange", "the farms exchange their addresses, and with them their workers", 20, Needs::kNothing,
     ExchangeAddresses},
    {"backup", "the data directory of a farm is copied", 15, Needs::kLargeDisk, BackUp},
    {"restore", "the data directory of a farm is replaced by the copy", 10, Needs::kLargeDisk, Restore},
    {"descriptors", "silent connections exhaust a coordinator's descriptors", 30, Needs::kNothing,
     ExhaustDescriptors},
    {"slow_disk", "the coordinators' writes and syncs take long", 30, Needs::kNoSanitizer, SlowDisks},
    {"stalled_clients", "clients stop in the middle of fetches and uploads", 20, Needs::kNothing,
     StallClients},
    {"deadly_scene", "a scene needs more memory than workers have", 2, Needs::kNoSanitizer,
     SubmitDeadlyScene},
    {"full_disk", "the disk of the data directories is full for a while", 100, Needs::kSmallDisk, FillDisk},
};

}  // namespace

Result<std::vector<size_t>> FindFaults(const std::vector<std::string>& names, bool small_disk) {
  const auto is_possible = [&](const FaultKind& kind) {
    if (kind.needs == Needs::kNoSanitizer) return !SlowDisk::Library().empty();
    return kind.needs != (small_disk ? Needs::kLargeDisk : Needs::kSmallDisk);
  };
  std::vector<size_t> found;
  for (const std::string& name : names) {
    const auto kind = std::ranges::find(kFaultKinds, std::string_view(name), &FaultKind::name);
    if (kind == std::end(kFaultKinds)) return BadInput(fmt::format("there is no fault \"{}\"", name));
    if (is_possible(*kind)) found.push_back(static_cast<size_t>(kind - std::begin(kFaultKinds)));
  }
  for (size_t kind = 0; kind < std::size(kFaultKinds) && names.empty(); ++kind) {
    if (is_possible(kFaultKinds[kind])) found.push_back(kind);
  }
  if (found.empty()) return BadInput("none of these faults is possible");
  return found;
}

std::string FaultsHelp() {
  std::string text;
  for (const FaultKind& kind : kFaultKinds) text += fmt::format("  {}: {}\n", kind.name, kind.effect);
  return text;
}

void Adversary::Strike() {
  const std::vector<size_t> missing = Missing();
  const bool is_missing_drawn = !missing.empty() && targets_.dice.Below(kMissingShare) == 0;
  const size_t kind =
      is_missing_drawn
          ? missing.at(static_cast<size_t>(targets_.dice.Below(static_cast<int>(missing.size()))))
          : DrawByWeight();
  if (kFaultKinds[kind].inject(targets_)) ++injected_[kind];
}

size_t Adversary::DrawByWeight() {
  int total = 0;
  for (const size_t kind : kinds_) total += kFaultKinds[kind].weight;
  int drawn = targets_.dice.Below(total);
  for (const size_t kind : kinds_) {
    drawn -= kFaultKinds[kind].weight;
    if (drawn < 0) return kind;
  }
  return kinds_.back();
}

std::vector<size_t> Adversary::Missing() const {
  std::vector<size_t> missing;
  for (const size_t kind : kinds_) {
    const auto found = injected_.find(kind);
    if ((found == injected_.end() ? 0 : found->second) < each_) missing.push_back(kind);
  }
  return missing;
}

std::string Adversary::Text() const {
  std::string text;
  for (const auto& [kind, count] : injected_)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", kFaultKinds[kind].name, count);
  return text;
}

}  // namespace tessera
