#include "tests/simulation/simulation_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "tests/simulation/random.h"

namespace tessera {

SimulationOptions DrawOptions(uint64_t seed) {
  Random random(Hash(seed, 77));
  const auto maybe = [&](double chance, double low, double high) {
    const double value = random.Real(low, high);
    return random.Chance(chance) ? value : 0;
  };
  SimulationOptions options;
  options.workers = random.Int(1, 6);
  options.jobs = random.Int(1, 3);
  options.loss = maybe(0.5, 0, 0.3);
  options.duplication = maybe(0.5, 0, 0.3);
  options.reordering = maybe(0.4, 0, 0.3);
  options.delay_max_s = random.Chance(0.5) ? random.Real(0, 1) : 0.002;
  options.slow_share = maybe(0.5, 0, 0.7);
  options.one_fails_units = random.Chance(0.3);
  options.one_damages_results = random.Chance(0.3);
  options.poison = random.Chance(0.15);
  options.cancel_one = random.Chance(0.15);
  options.verify_share = maybe(0.3, 0.05, 1);
  options.one_lies = random.Chance(0.15);
  if (options.one_lies) options.verify_share = 1;
  options.noise_threshold = maybe(0.5, 0.02, 0.3);
  Random later(Hash(seed, 79));  // a new option does not change the others of a seed
  options.killer = later.Chance(0.15);
  if (later.Chance(0.3) && options.verify_share == 0) options.ordered_share = 0.7;
  options.faults = DrawFaults(seed, options.faults_s);
  return options;
}

size_t SimulationOptions::directories() const {
  const size_t swap = FaultKindOf("swap");
  return std::ranges::any_of(faults, [&](const PlannedFault& each) { return each.kind == swap; }) ? 2 : 1;
}

std::string SimulationOptions::Text() const {
  return fmt::format(
      "workers={} jobs={} loss={:.2f} duplication={:.2f} reordering={:.2f} delay_max_s={:.3f} "
      "slow_share={:.2f} "
      "faults={} one_fails_units={} one_damages_results={} poison={} killer={} cancel_one={} "
      "verify_share={:.2f} "
      "one_lies={} "
      "noise_threshold={:.3f} ordered_share={:.2f} one_never_prepares={}",
      workers, jobs, loss, duplication, reordering, delay_max_s, slow_share, FaultsText(faults),
      one_fails_units, one_damages_results, poison, killer, cancel_one, verify_share, one_lies,
      noise_threshold, ordered_share, one_never_prepares);
}

}  // namespace tessera
