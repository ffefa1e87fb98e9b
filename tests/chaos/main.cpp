// `chaos`: a farm of real processes renders a set of jobs again and again while its processes are killed,
// stopped and started at random. At the end every picture must have the bits of the undisturbed one, nothing
// that was acknowledged may have been acknowledged again, and nothing may be left behind. Exit code 0 if it
// is so, 77 if there can be no small file system.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "tests/chaos/chaos_run.h"

int main(int argc, char** argv) {
  tessera::ChaosOptions options;
  CLI::App app("Hurts a farm of real processes and looks at what it makes of it.", "chaos");
  app.add_option("--seed", options.seed, "of the faults");
  app.add_option("--seconds", options.seconds, "go on for so long");
  app.add_option("--worker-faults", options.worker_faults,
                 "and until so many workers were killed or stopped");
  app.add_option("--coordinator-faults", options.coordinator_faults, "and the coordinator so often");
  app.add_option("--workers", options.workers, "worker processes")->check(CLI::Range(1, 64));
  app.add_flag("--small-disk", options.small_disk,
               "put the data on a small file system that fills up; needs root, or user namespaces");
  app.add_option("--spp", options.samples_per_pixel, "of the pictures");
  CLI11_PARSE(app, argc, argv);
  const tessera::ChaosReport report = tessera::RunChaos(options);
  fmt::print("{}\n", report.Text());
  if (!report.skipped.empty()) return 77;
  return report.Passed() ? 0 : 1;
}
