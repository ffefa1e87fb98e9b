#include "tests/chaos/customer.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "renderer/util/file.h"
#include "tests/build_paths.h"
#include "tests/end_to_end/process.h"

namespace tessera {
namespace {

constexpr std::chrono::minutes kJobPatience{10};  // of a farm with faults
// With a full disk the farm refuses the files of a scene. A user frees space and tries again.
constexpr const char* kDiskFull = "No space left on device";
// A file of the scene was damaged before a worker had it. The next submission sends it again.
constexpr const char* kFileLost = "or found it corrupt; submit the scene again";
constexpr std::chrono::milliseconds kDiskFullPause{200};
constexpr uint64_t kPictureBytesMax = uint64_t{1} << 30;
constexpr int kFrames = 3;

std::string Bytes(const std::string& path) {
  const auto bytes = ReadFile(path, kPictureBytesMax);
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
  const Outcome outcome = RunProgram(folder, "tessera", words);
  if (outcome.code != 0) throw std::runtime_error("the undisturbed picture failed: " + outcome.errors);
  for (int frame = 1; frame <= frames; ++frame) {
    job.pictures.push_back(
        Bytes(folder + (frames > 1 ? fmt::format("/oracle.{}.exr", frame) : "/oracle.exr")));
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

void Customers::Work(size_t customer) {
  for (size_t i = customer; !closed_; ++i) {
    if (!Do(jobs_[i % jobs_.size()], customer)) return;
  }
}

bool Customers::Do(const ChaosJob& job, size_t customer) {
  std::vector<std::string> words{"submit", job.scene};
  words.insert(words.end(), job.options.begin(), job.options.end());
  std::string answer, id;
  bool has_lost_files = false;
  do {
    if (!Ask(words, &answer)) return false;
    id = answer.substr(0, answer.find('\n'));
    if (!Ask({"watch", id}, &answer, &has_lost_files)) return false;
  } while (has_lost_files);
  const std::string output = fmt::format("{}/customer-{}", folder_, customer);
  const bool is_sequence = job.pictures.size() > 1;
  if (!Ask({"fetch", id, "-o", output + (is_sequence ? ".#.exr" : ".exr")}, &answer)) return false;
  for (size_t i = 0; i < job.pictures.size(); ++i) {
    const std::string path = is_sequence ? fmt::format("{}.{}.exr", output, i + 1) : output + ".exr";
    ++pictures_;
    if (Bytes(path) != job.pictures[i]) {
      Report(fmt::format("frame {} of job {} ({}) differs from the undisturbed picture", i, id, job.scene));
    }
    std::filesystem::remove(path);
  }
  return true;
}

bool Customers::Ask(std::vector<std::string> arguments, std::string* answer, bool* has_lost_files) {
  if (has_lost_files != nullptr) *has_lost_files = false;
  arguments.insert(arguments.end(), {"--coordinator", address_, "--patience", "120"});
  const auto deadline = std::chrono::steady_clock::now() + kJobPatience;
  while (true) {
    Process process(folder_, "tessera", arguments);
    std::optional<int> code;
    while (!code && !gave_up_ && std::chrono::steady_clock::now() < deadline) {
      code = process.Wait(std::chrono::milliseconds(200));
    }
    *answer = process.Output();
    if (code == 0) return true;
    const std::string errors = process.Errors();
    if (code == 1 && errors.find(kDiskFull) != std::string::npos && !gave_up_) {
      std::this_thread::sleep_for(kDiskFullPause);
      continue;
    }
    if (code == 1 && has_lost_files != nullptr && errors.find(kFileLost) != std::string::npos) {
      *has_lost_files = true;
      return true;
    }
    Report(fmt::format("tessera {} {} {}: {}", arguments[0], arguments[1],
                       code ? fmt::format("ended with {}", *code) : "took too long", errors));
    return false;
  }
}

void Customers::Report(const std::string& problem) {
  const std::lock_guard lock(mutex_);
  problems_.push_back(problem);
}

std::vector<std::string> Customers::problems() const {
  const std::lock_guard lock(mutex_);
  return problems_;
}

}  // namespace tessera
