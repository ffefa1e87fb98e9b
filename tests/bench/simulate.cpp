// Runs seeds of the fault simulation and can print everything that happens.
#include <CLI/CLI.hpp>

#include <cstdio>

#include "tests/simulation/simulation.h"

namespace {

// Whether all invariants held.
bool RunSeed(uint64_t seed, bool trace) {
  using namespace tessera;
  const auto print = [](const std::string& line) { std::fputs(line.c_str(), stdout); };
  const SimulationReport report =
      Simulation(seed, DrawOptions(seed), trace ? Simulation::OnTrace(print) : nullptr).Run();
  for (const std::string& violation : report.violations) {
    std::printf("seed %lu at %s\n", seed, violation.c_str());
  }
  if (trace) {
    std::printf(
        "ended_s=%.3f results=%d duplicates=%d refused=%d crashes=%d rendered=%lu needed=%lu trace=%s\n",
        report.ended_s, report.results, report.duplicates, report.refused, report.crashes,
        report.samples_rendered, report.samples_needed, report.trace.Hex().c_str());
  }
  return report.violations.empty();
}

}  // namespace

int main(int argc, char** argv) {
  uint64_t seed = 1, count = 1;
  bool trace = false;
  CLI::App app("Run the fault simulation of a small farm; exit with 1 if an invariant is broken");
  app.add_option("--seed", seed, "First seed");
  app.add_option("--count", count, "Number of seeds");
  app.add_flag("--trace", trace, "Print everything that happens");
  CLI11_PARSE(app, argc, argv);
  uint64_t broken = 0;
  for (uint64_t s = seed; s < seed + count; ++s) broken += RunSeed(s, trace) ? 0 : 1;
  std::printf("%lu of %lu seeds broke an invariant\n", broken, count);
  return broken == 0 ? 0 : 1;
}
