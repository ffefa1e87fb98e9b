// The faults of a chaos run: a table, from which they are drawn.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "renderer/util/result.h"
#include "tests/chaos/chaos_farms.h"
#include "tests/chaos/chaos_folder.h"
#include "tests/chaos/customer.h"
#include "tests/chaos/memory_limit.h"
#include "tests/chaos/silent_connections.h"
#include "tests/chaos/slow_disk.h"
#include "tests/chaos/stalled_clients.h"
#include "tests/end_to_end/process.h"

namespace tessera {

// Draws numbers.
class Dice {
 public:
  explicit Dice(uint64_t seed) : random_(seed) {}
  int Below(int limit) { return std::uniform_int_distribution<int>(0, limit - 1)(random_); }
  std::chrono::milliseconds Between(int from_ms, int to_ms) {
    return std::chrono::milliseconds(std::uniform_int_distribution<int>(from_ms, to_ms)(random_));
  }
  std::mt19937_64& engine() { return random_; }

 private:
  std::mt19937_64 random_;
};

// Clients that must be answered soon although something is or was wrong.
class Probes {
 public:
  Probes(std::string folder, const ChaosFarms& farms, const FarmHistory& history)
      : folder_(std::move(folder)), farms_(farms), history_(history) {}
  // Asks a farm for its workers. `why` completes "was not answered".
  void Ask(int farm, std::string why);
  // Judges what has been answered. Does not count if the coordinator was away meanwhile.
  void Tick();
  bool IsWaiting(int farm) const;
  int answered() const { return answered_; }
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  struct Probe {
    int farm;
    int faults;  // of the farm's coordinator before
    Clock::time_point deadline;
    std::string why;
    Process process;
  };
  const std::string folder_;
  const ChaosFarms& farms_;
  const FarmHistory& history_;
  std::vector<std::unique_ptr<Probe>> waiting_;
  int answered_ = 0;
  std::vector<std::string> problems_;
};

// What faults act on.
struct FaultTargets {
  const ChaosFolder& folder;
  ChaosFarms& farms;
  const FarmHistory& history;
  Customers& customers;
  DiskFiller& filler;
  SlowDisk& slow_disk;
  std::array<SilentConnections, kFarms>& connections;
  StalledClients& stalled;
  Probes& probes;
  Dice& dice;
};

// The indices of the faults of these names, or of all, that are possible in this build on such a disk. An
// error for a name that is not in the table.
Result<std::vector<size_t>> FindFaults(const std::vector<std::string>& names, bool small_disk);
// "name: effect", one a line.
std::string FaultsHelp();

// Draws faults and injects them.
class Adversary {
 public:
  // Each kind is to be injected `each` times at least.
  Adversary(std::vector<size_t> kinds, int each, FaultTargets targets)
      : kinds_(std::move(kinds)), each_(each), targets_(targets) {}

  // Draws a fault and injects it, if that is possible now.
  void Strike();
  bool IsDone() const { return Missing().empty(); }
  // "name: number", separated by commas.
  std::string Text() const;

 private:
  size_t DrawByWeight();
  std::vector<size_t> Missing() const;

  const std::vector<size_t> kinds_;
  const int each_;
  FaultTargets targets_;
  std::map<size_t, int> injected_;  // by kind
};

}  // namespace tessera
