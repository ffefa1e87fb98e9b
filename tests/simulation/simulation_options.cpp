#include "tests/simulation/simulation_options.h"

#include <fmt/format.h>

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
  options.partition_interval_s = maybe(0.4, 3, 30);
  options.slow_share = maybe(0.5, 0, 0.7);
  options.death_interval_s = maybe(0.5, 2, 30);
  options.drain_interval_s = maybe(0.3, 5, 30);
  options.hang_interval_s = maybe(0.5, 2, 30);
  options.crash_interval_s = maybe(0.5, 3, 40);
  options.blackout_interval_s = maybe(0.15, 10, 40);
  options.full_disk_interval_s = maybe(0.3, 5, 40);
  options.clock_jump_interval_s = maybe(0.3, 3, 40);
  options.one_fails_units = random.Chance(0.3);
  options.one_damages_results = random.Chance(0.3);
  options.poison = random.Chance(0.15);
  options.cancel_one = random.Chance(0.15);
  options.verify_share = maybe(0.3, 0.05, 1);
  options.one_lies = random.Chance(0.15);
  if (options.one_lies) options.verify_share = 1;
  options.pause_interval_s = maybe(0.3, 1, 10);
  options.priority_interval_s = maybe(0.3, 1, 10);
  options.noise_threshold = maybe(0.5, 0.02, 0.3);
  return options;
}

std::string SimulationOptions::Text() const {
  return fmt::format(
      "workers={} jobs={} loss={:.2f} duplication={:.2f} reordering={:.2f} delay_max_s={:.3f} "
      "partition_interval_s={:.1f} slow_share={:.2f} death_interval_s={:.1f} drain_interval_s={:.1f} "
      "hang_interval_s={:.1f} crash_interval_s={:.1f} blackout_interval_s={:.1f} full_disk_interval_s={:.1f} "
      "clock_jump_interval_s={:.1f} one_fails_units={} one_damages_results={} poison={} cancel_one={} "
      "verify_share={:.2f} one_lies={} pause_interval_s={:.1f} priority_interval_s={:.1f} "
      "noise_threshold={:.3f}",
      workers, jobs, loss, duplication, reordering, delay_max_s, partition_interval_s, slow_share,
      death_interval_s, drain_interval_s, hang_interval_s, crash_interval_s, blackout_interval_s,
      full_disk_interval_s, clock_jump_interval_s, one_fails_units, one_damages_results, poison, cancel_one,
      verify_share, one_lies, pause_interval_s, priority_interval_s, noise_threshold);
}

}  // namespace tessera
