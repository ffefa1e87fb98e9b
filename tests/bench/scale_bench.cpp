// How well the scheduler uses farms of 10 to 10,000 workers of which a tenth is ten times slower and a
// twentieth dies each minute: prints one line for each size, as a table or, with --csv, for other programs.
#include <CLI/CLI.hpp>

#include <cstdio>
#include <vector>

#include "tests/simulation/scale_farm.h"

int main(int argc, char** argv) {
  using namespace tessera;
  std::vector<int> sizes{10, 100, 1000, 10'000};
  double ideal_s = 300;
  uint64_t seed = 1;
  bool csv = false;
  CLI::App app(
      "Simulate farms; print the makespan over its lower bound, the waste and the coordinator's own time");
  app.add_option("--workers", sizes, "Sizes of the farms")->check(CLI::Range(1, 100'000));
  app.add_option("--seconds", ideal_s, "Duration of the frame if all machines always worked on it")
      ->check(CLI::Range(1.0, 1e6));
  app.add_option("--seed", seed, "Seed of the simulation");
  app.add_flag("--csv", csv, "Print comma-separated values");
  CLI11_PARSE(app, argc, argv);

  std::printf(csv ? "workers,ideal_s,makespan_s,ratio,waste,lost,copied,absent,results,results_per_s,calls,"
                    "core_us_per_call\n"
                  : "workers  ideal_s  makespan_s  ratio  waste%%  lost%%  copied%%  absent%%  results  "
                    "results/s    calls  core_us/call\n");
  for (const int workers : sizes) {
    ScaleOptions options = ScaleOptionsFor(workers, ideal_s);
    options.seed = seed;
    const ScaleReport report = ScaleFarm(options).Run();
    if (!report.finished) {
      std::fprintf(stderr, "scale_bench: %d workers did not finish\n", workers);
      return 1;
    }
    std::printf(csv ? "%d,%.1f,%.2f,%.4f,%.5f,%.5f,%.5f,%.5f,%lu,%.1f,%lu,%.3f\n"
                    : "%7d  %7.1f  %10.2f  %5.3f  %6.2f  %5.2f  %7.2f  %7.2f  %7lu  %9.1f  %7lu  %12.2f\n",
                workers, report.ideal_s, report.makespan_s, report.Ratio(), report.Waste() * (csv ? 1 : 100),
                report.lost_to_deaths * (csv ? 1 : 100), report.copied * (csv ? 1 : 100),
                report.absent * (csv ? 1 : 100), report.results,
                static_cast<double>(report.results) / report.makespan_s, report.calls,
                report.core_cpu_s / static_cast<double>(report.calls) * 1e6);
    std::fflush(stdout);
  }
  return 0;
}
