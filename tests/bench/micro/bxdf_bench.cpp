// BxDFs of every kind: sampling, and value and density together.
#include "tests/bench/micro/micro_bench.h"
#include "tests/renderer/bxdf/bxdf_examples.h"

namespace tessera {
namespace {

constexpr size_t kDirections = 1024;

// Over the hemisphere of z, seldom grazing.
std::vector<Vec3> Directions(uint64_t seed) {
  const NumberRing numbers(seed);
  std::vector<Vec3> directions;
  for (size_t i = 0; i < kDirections; ++i)
    directions.push_back(DirectionAt(0.05f + 0.95f * numbers.At(2 * i), 2 * kPi * numbers.At(2 * i + 1)));
  return directions;
}

void AddSample(const BxdfExample& example) {
  AddBenchmark("bxdf/sample/" + example.name,
               [bxdf = example.bxdf, wo = Directions(1), numbers = NumberRing(2)](size_t i) {
                 return bxdf.Sample(wo[i % kDirections], numbers.At(3 * i),
                                    {numbers.At(3 * i + 1), numbers.At(3 * i + 2)});
               });
}

void AddEvaluate(const BxdfExample& example) {
  AddBenchmark("bxdf/evaluate_with_density/" + example.name,
               [bxdf = example.bxdf, wo = Directions(1), wi = Directions(3)](size_t i) {
                 return bxdf.Evaluate(wo[i % kDirections], wi[(i + i / kDirections) % kDirections]);
               });
}

}  // namespace

void AddBxdfBenchmarks() {
  for (const BxdfExample& example : RoughExamples()) {
    AddSample(example);
    AddEvaluate(example);
  }
  for (const BxdfExample& example : SpecularExamples()) AddSample(example);
}

}  // namespace tessera
