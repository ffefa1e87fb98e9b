// `chaos`: a farm of real processes renders a set of jobs repeatedly while its processes are killed, stopped
// and restarted at random. Every picture must have the bits of an undisturbed render, no result may be
// acknowledged twice, and no files or processes may be left. Exits with 0 on success, 1 on failure, and 77 if
// a small file system is requested and cannot be mounted.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "tests/chaos/chaos_run.h"

int main(int argc, char** argv) {
  tessera::ChaosOptions options;
  CLI::App app("Inject faults into a farm of real processes and check its pictures.", "chaos");
  app.add_option("--seed", options.seed, "Random seed of the faults");
  app.add_option("--seconds", options.seconds, "Minimum duration");
  app.add_option("--worker-faults", options.worker_faults,
                 "Minimum number of workers that are killed or stopped");
  app.add_option("--coordinator-faults", options.coordinator_faults,
                 "Minimum number of times that the coordinator is killed or stopped");
  app.add_option("--workers", options.workers, "Number of worker processes")->check(CLI::Range(1, 64));
  app.add_flag("--small-disk", options.small_disk,
               "Put the data directory on a small file system that fills up; needs root or user namespaces");
  app.add_option("--spp", options.samples_per_pixel, "Samples per pixel of the pictures");
  CLI11_PARSE(app, argc, argv);
  const tessera::ChaosReport report = tessera::RunChaos(options);
  fmt::print("{}\n", report.Text());
  if (!report.skipped.empty()) return 77;
  return report.Passed() ? 0 : 1;
}
