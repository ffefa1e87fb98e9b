// Samplers of every kind: a sample with as many dimensions as a path of some vertices draws.
#include "renderer/sampler/sampler_settings.h"
#include "tests/bench/micro/micro_bench.h"

namespace tessera {
namespace {

constexpr int kPictureSide = 512;
constexpr int kVertices = 4;
constexpr uint32_t kPixelSamples = 64;

// What a camera path draws: the film, the wavelengths, then for each vertex a light, a point on it, a lobe
// and a direction.
float DrawPath(Sampler& sampler) {
  float sum = sampler.Get2D().x + sampler.Get1D();
  for (int vertex = 0; vertex < kVertices; ++vertex) {
    sum += sampler.Get1D();
    sum += sampler.Get2D().y;
    sum += sampler.Get1D();
    sum += sampler.Get2D().x;
  }
  return sum;
}

// The samples of a pixel one after another, then the next pixel.
float DrawNext(Sampler& sampler, size_t i) {
  const size_t pixel = i / kPixelSamples;
  sampler.StartSample(static_cast<int>(pixel % kPictureSide),
                      static_cast<int>(pixel / kPictureSide % kPictureSide),
                      static_cast<uint32_t>(i % kPixelSamples));
  return DrawPath(sampler);
}

void AddSamplerKind(std::string_view kind) {
  const std::string name = "sampler/path_of_4_vertices/" + std::string(kind);
  Entity entity;
  entity.kind = kind;
  Diagnostics diagnostics;
  const auto settings =
      ReadSampler(entity, kPictureSide, kPictureSide, {kPixelSamples, std::nullopt}, 0, diagnostics);
  if (!settings) return AddFailure(name, settings.error().message);
  AddBenchmark(name, [sampler = settings->sampler](size_t i) mutable { return DrawNext(sampler, i); });
}

}  // namespace

void AddSamplerBenchmarks() {
  for (const KindInfo& kind : SamplerKinds().kinds) {
    if (kind.support == Support::kSupported) AddSamplerKind(kind.name);
  }
}

}  // namespace tessera
