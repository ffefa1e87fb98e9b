// Micro-benchmarks of the parts of the renderer and the film. Each file measures one subject. What has a
// table of kinds is measured by iterating over it, so a new kind is measured without an edit.
#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

// Registers a benchmark that calls body(i) for i = 0, 1, 2, ... The body owns or shares what it uses, and
// returns what it computes, so that the compiler keeps the computation.
template <typename Body>
void AddBenchmark(const std::string& name, Body body) {
  const auto run = [body = std::move(body)](benchmark::State& state) mutable {
    size_t i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(body(i++));
  };
  benchmark::RegisterBenchmark(name.c_str(), run);
}

// Registers a benchmark that fails with `reason`, for what cannot be made.
void AddFailure(const std::string& name, const std::string& reason);

// Numbers in [0, 1) that are read in a circle: drawing them costs a load.
class NumberRing {
 public:
  explicit NumberRing(uint64_t seed);
  float At(size_t i) const { return values_[i % kSize]; }

 private:
  static constexpr size_t kSize = 4096;
  std::vector<float> values_;
};

// Each registers the benchmarks of its subject.
void AddTraversalBenchmarks();
void AddBxdfBenchmarks();
void AddSamplerBenchmarks();
void AddSpectrumBenchmarks();
void AddTextureBenchmarks();
void AddLightBenchmarks();
void AddFilmBenchmarks();

}  // namespace tessera
