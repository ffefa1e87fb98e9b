// `chaos`: two farms of real processes render a set of jobs repeatedly while their processes are killed,
// stopped and restarted, their files damaged, exchanged and restored, and their resources used up. Every
// picture must have the bits of an undisturbed render, no result may be acknowledged twice, and no files or
// processes may be left. Exits with 0 on success, 1 on failure, and 77 if a small file system is requested
// and cannot be mounted.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "tests/chaos/chaos_run.h"
#include "tests/chaos/faults.h"

int main(int argc, char** argv) {
  tessera::ChaosOptions options;
  CLI::App app("Inject faults into farms of real processes and check their pictures.", "chaos");
  app.footer("Faults:\n" + tessera::FaultsHelp());
  app.add_option("--seed", options.seed, "Random seed of the faults");
  app.add_option("--seconds", options.seconds, "Minimum duration");
  app.add_option("--faults", options.faults, "Faults to inject, separated by commas (default: all)")
      ->delimiter(',');
  app.add_option("--each", options.each, "Minimum number of times that each fault is injected");
  app.add_option("--pause", options.pause_ms, "Average time between two faults in milliseconds")
      ->check(CLI::Range(1, 1'000'000));
  app.add_option("--workers", options.workers, "Number of worker processes")->check(CLI::Range(2, 64));
  app.add_flag(
      "--small-disk", options.small_disk,
      "Put the data directories on a small file system that fills up; needs root or user namespaces");
  app.add_option("--spp", options.samples_per_pixel, "Samples per pixel of the pictures");
  CLI11_PARSE(app, argc, argv);
  const tessera::ChaosReport report = tessera::RunChaos(options);
  fmt::print("{}\n", report.Text());
  if (!report.skipped.empty()) return 77;
  return report.Passed() ? 0 : 1;
}
