#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "renderer/util/file.h"
#include "tests/build_paths.h"
#include "tests/chaos/customer.h"
#include "tests/end_to_end/process.h"

namespace tessera {
namespace {

constexpr uint64_t kOracleBytesMax = uint64_t{1} << 30;
constexpr int kFrames = 3;
// What one sphere with a place of its own takes at least in the memory of a worker that loads it.
constexpr uint64_t kSphereBytesMin = 900;
constexpr uint64_t kSpheresPerFile = 20'000;

std::string BytesOf(const std::string& path) {
  const auto bytes = ReadFile(path, kOracleBytesMax);
  return bytes ? *bytes : std::string();
}

void WriteSequence(const std::string& folder, int samples_per_pixel) {
  for (int frame = 1; frame <= kFrames; ++frame) {
    std::ofstream(fmt::format("{}/scene.{:04}.pbrt", folder, frame)) << fmt::format(
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 48\n"
        "Sampler \"sobol\" \"integer pixelsamples\" {}\nLookAt {} 1 -5  0 0 0  0 1 0\nCamera "
        "\"perspective\"\n"
        "WorldBegin\nLightSource \"infinite\" \"rgb L\" [ 0.6 0.7 0.9 ]\n"
        "Material \"dielectric\" Shape \"sphere\"\nMaterial \"diffuse\" Translate 0 -1 0 Rotate 90 1 0 0\n"
        "Shape \"disk\" \"float radius\" 4\n",
        samples_per_pixel, frame);
  }
}

ChaosJob Prepare(const std::string& folder, std::string scene, std::vector<std::string> options, int frames) {
  ChaosJob job{std::move(scene), std::move(options), {}};
  std::vector<std::string> words{"render", job.scene, "--in-process", "-o",
                                 frames > 1 ? "oracle.#.exr" : "oracle.exr"};
  words.insert(words.end(), job.options.begin(), job.options.end());
  const auto outcome = RunProgram(folder, "tessera", words);
  if (outcome.code != 0) throw std::runtime_error("the undisturbed picture failed: " + outcome.errors);
  for (int frame = 1; frame <= frames; ++frame) {
    job.pictures.push_back(
        BytesOf(folder + (frames > 1 ? fmt::format("/oracle.{}.exr", frame) : "/oracle.exr")));
  }
  return job;
}

}  // namespace

std::vector<ChaosJob> PrepareJobs(const std::string& folder, int samples_per_pixel) {
  const std::string scenes = SourceDir() + "/tests/scenes/";
  const auto spp = [&](int divisor) { return std::to_string(std::max(1, samples_per_pixel / divisor)); };
  WriteSequence(folder, samples_per_pixel);
  return {Prepare(folder, scenes + "box.pbrt", {"--spp", spp(1), "--tile-size", "16"}, 1),
          Prepare(folder, scenes + "box.pbrt",
                  {"--spp", spp(1), "--tile-size", "16", "--noise-threshold", "0.1", "--aov", "samples"}, 1),
          Prepare(folder, folder + "/scene.####.pbrt", {"--frames", fmt::format("1-{}", kFrames)}, kFrames),
          Prepare(folder, scenes + "original/materials.pbrt", {"--spp", spp(8), "--resolution", "96x96"}, 1)};
}

ChaosJob PrepareDeadlyJob(const std::string& folder, uint64_t bytes) {
  std::ofstream spheres(folder + "/spheres.pbrt");
  for (uint64_t i = 0; i < kSpheresPerFile; ++i)
    spheres << "AttributeBegin Translate 0 0 " << i << " Shape \"sphere\" AttributeEnd\n";
  std::ofstream scene(folder + "/deadly.pbrt");
  scene << "LookAt 0 0 -9 0 0 0 0 1 0\nCamera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\n";
  for (uint64_t i = 0; i <= bytes / (kSphereBytesMin * kSpheresPerFile); ++i)
    scene << "Translate 3 0 0 Include \"spheres.pbrt\"\n";
  return {folder + "/deadly.pbrt", {"--spp", "1", "--resolution", "16x16"}, {}};
}

}  // namespace tessera
