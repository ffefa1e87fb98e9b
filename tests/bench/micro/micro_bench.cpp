// micro_bench: runs the micro-benchmarks. Options are those of Google Benchmark:
//   micro_bench --benchmark_filter='^bxdf/' --benchmark_repetitions=5
// Returns 1 if one of them cannot be measured.
#include "tests/bench/micro/micro_bench.h"

#include "tests/chi_square.h"

namespace tessera {

NumberRing::NumberRing(uint64_t seed) : values_(kSize) {
  TestRandom random(seed);
  for (float& value : values_) value = random.Next();
}

void AddFailure(const std::string& name, const std::string& reason) {
  benchmark::RegisterBenchmark(name.c_str(), [reason](benchmark::State& state) {
    state.SkipWithError(reason.c_str());
    for (auto _ : state) {
    }
  });
}

namespace {

class FailureCounter : public benchmark::ConsoleReporter {
 public:
  // Colours and the width of names as for the default reporter on a file.
  FailureCounter() : ConsoleReporter(OO_None) {}
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) failures_ += run.error_occurred ? 1 : 0;
    ConsoleReporter::ReportRuns(runs);
  }
  int failures() const { return failures_; }

 private:
  int failures_ = 0;
};

int RunAll(int argc, char** argv) {
  AddTraversalBenchmarks();
  AddBxdfBenchmarks();
  AddSamplerBenchmarks();
  AddSpectrumBenchmarks();
  AddTextureBenchmarks();
  AddLightBenchmarks();
  AddFilmBenchmarks();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  FailureCounter reporter;
  const size_t run = benchmark::RunSpecifiedBenchmarks(&reporter);
  return run > 0 && reporter.failures() == 0 ? 0 : 1;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  return tessera::RunAll(argc, argv);
}
