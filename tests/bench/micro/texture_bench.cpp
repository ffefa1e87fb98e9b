// Textures of every kind, constants, and lookups in images by every filter.
#include <array>
#include <memory>

#include "renderer/texture/texture_kinds.h"
#include "tests/bench/micro/micro_bench.h"
#include "tests/renderer/texture/texture_scene.h"

namespace tessera {
namespace {

constexpr int kImageSide = 1024;
constexpr const char* kImageName = "image.pfm";

std::map<std::string, std::string> Files() {
  const NumberRing numbers(1);
  std::vector<float> values;
  for (size_t i = 0; i < size_t{3} * kImageSide * kImageSide; ++i) values.push_back(numbers.At(i));
  return {{kImageName, FloatMap(kImageSide, kImageSide, values)}};
}

// Places all over the texture, with the footprint of some texels, longer than wide.
class Places {
 public:
  TextureContext At(size_t i) const {
    TextureContext context = ContextAtUv(numbers_.At(2 * i), numbers_.At(2 * i + 1));
    context.p = {7 * context.uv.x, 7 * context.uv.y, 3 * numbers_.At(2 * i + 2)};
    context.dudx = 3.0f / kImageSide;
    context.dvdx = 1.0f / kImageSide;
    context.dvdy = 1.5f / kImageSide;
    context.dpdx = {0.01f, 0.002f, 0};
    context.dpdy = {0, 0.01f, 0.003f};
    return context;
  }

 private:
  NumberRing numbers_{4};
};

SampledWavelengths SomeWavelengths() {
  return SampledWavelengths::SampleVisible(0.4f);
}

struct Request {
  std::string name;        // of the benchmark
  std::string kind;        // of texture
  std::string parameters;  // of the Texture directive
};

void AddSpectrumTexture(const Request& request) {
  TextureScene scene(Files());
  std::string error = scene.Build("Texture \"t\" \"spectrum\" \"" + request.kind + "\" " + request.parameters,
                                  "\"texture reflectance\" \"t\"");
  const SpectrumInput input = error.empty() ? scene.SpectrumInputOf("reflectance") : SpectrumInput{};
  if (error.empty()) error = scene.error();
  if (!error.empty()) return AddFailure(request.name, error);
  const auto table = std::make_shared<const TextureTable>(scene.Finish());
  AddBenchmark(request.name, [table, input, places = Places()](size_t i) {
    return table->Evaluate(input, places.At(i), SomeWavelengths());
  });
}

void AddFloatTexture(const Request& request) {
  TextureScene scene(Files());
  std::string error = scene.Build("Texture \"t\" \"float\" \"" + request.kind + "\" " + request.parameters,
                                  "\"texture displacement\" \"t\"");
  const FloatInput input = error.empty() ? scene.FloatInputOf("displacement") : FloatInput{};
  if (error.empty()) error = scene.error();
  if (!error.empty()) return AddFailure(request.name, error);
  const auto table = std::make_shared<const TextureTable>(scene.Finish());
  AddBenchmark(request.name,
               [table, input, places = Places()](size_t i) { return table->Evaluate(input, places.At(i)); });
}

// What a kind must be given.
std::string RequiredParameters(std::string_view kind) {
  return kind == "imagemap" ? std::string("\"string filename\" \"") + kImageName + "\"" : "";
}

void AddKinds(const KindList& list, const std::string& type, void (*add)(const Request&)) {
  for (const KindInfo& kind : list.kinds) {
    if (kind.support != Support::kSupported) continue;
    const std::string name(kind.name);
    add({"texture/" + type + "/" + name, name, RequiredParameters(name)});
  }
}

void AddConstants() {
  const auto table = std::make_shared<const TextureTable>();
  const Spectrum sigmoid = ColorSpace::Srgb().ToSpectrum({0.2f, 0.5f, 0.7f}, SpectrumUse::kAlbedo);
  AddBenchmark("texture/float/no_texture", [table, places = Places()](size_t i) {
    return table->Evaluate(FloatInput{0.5f, -1}, places.At(i));
  });
  AddBenchmark("texture/spectrum/no_texture",
               [table, input = SpectrumInput{sigmoid, -1}, places = Places()](size_t i) {
                 return table->Evaluate(input, places.At(i), SomeWavelengths());
               });
}

}  // namespace

void AddTextureBenchmarks() {
  AddConstants();
  AddKinds(FloatTextureKinds(), "float", AddFloatTexture);
  AddKinds(SpectrumTextureKinds(), "spectrum", AddSpectrumTexture);
  for (const std::string filter : {"point", "bilinear", "trilinear", "ewa"}) {
    const std::string parameters = RequiredParameters("imagemap") + " \"string filter\" \"" + filter + "\"";
    AddSpectrumTexture({"texture/image_filter/spectrum/" + filter, "imagemap", parameters});
    AddFloatTexture({"texture/image_filter/float/" + filter, "imagemap", parameters});
  }
}

}  // namespace tessera
