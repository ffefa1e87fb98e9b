// tessera info
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "client/commands/commands.h"
#include "client/commands/option_groups.h"
#include "client/commands/picture_info.h"
#include "client/scene_job.h"

namespace tessera {
namespace {

struct InfoOptions {
  SceneOptions scene;
  bool json = false;
};

void AddInfoFlags(CLI::App& app, InfoOptions& options) {
  AddSceneFlags(app, options.scene);
  AddSceneMemoryFlag(app, options.scene);
  AddJsonFlag(app, options.json);
}

uint64_t FileBytes(const ScenePackage& package) {
  uint64_t bytes = 0;
  for (const auto& [path, file] : package.files) bytes += file.size;
  return bytes;
}

void PrintAccelerator(const AcceleratorSummary& accelerator) {
  fmt::print("  {:<9} ", accelerator.kind);
  if (!accelerator.refusal.empty()) {
    fmt::print("{}\n", accelerator.refusal);
    return;
  }
  fmt::print("built in {:.3f} s, {} bytes", accelerator.build_seconds, accelerator.bytes);
  if (accelerator.nodes > 0) fmt::print(", {} nodes", accelerator.nodes);
  if (accelerator.surface_area_cost > 0) {
    fmt::print(", surface area cost {:.2f}", accelerator.surface_area_cost);
  }
  fmt::print("\n");
}

void PrintText(const SceneJob& job) {
  const SceneSummary& scene = job.scene->summary();
  const FrameSpec& frame = job.packed.frames[0].spec;
  if (job.frames.size() > 1) {
    fmt::print("frames      {}, {} to {}, all readable; frame {}:\n", job.frames.size(),
               job.frames.front().number, job.frames.back().number, job.frames.front().number);
  }
  const PixelBounds& crop = frame.crop;
  fmt::print("picture     {}x{} pixels", frame.width, frame.height);
  if (crop != PixelBounds{0, 0, frame.width, frame.height}) {
    fmt::print(", of which {},{} to {},{}", crop.x0, crop.y0, crop.x1, crop.y1);
  }
  fmt::print(", {} samples per pixel\n", frame.samples_per_pixel);
  fmt::print("camera      {}\nfilm        {}\nfilter      {}\nsampler     {}\nintegrator  {}\n", scene.camera,
             scene.film, scene.filter, scene.sampler, scene.integrator);
  fmt::print("accelerator {}\n", scene.accelerator);
  for (const AcceleratorSummary& accelerator : scene.accelerators) PrintAccelerator(accelerator);
  fmt::print("shapes      {}: ", scene.shapes);
  for (const PrimitiveTotal& total : scene.primitives) fmt::print("{} {}, ", total.count, total.name);
  fmt::print("{} bytes\n", scene.geometry_bytes);
  fmt::print("instances   {} of {} groups\n", scene.instances, scene.groups);
  if (scene.moving > 0) fmt::print("moving      {} of camera, shapes, instances and lights\n", scene.moving);
  fmt::print("lights      {}\nmaterials   {}\nmedia       {}\n", scene.lights, scene.materials, scene.media);
  fmt::print("textures    {}, images of {} bytes\n", scene.textures, scene.image_bytes);
  fmt::print("files       {}, {} bytes\n", job.packed.package.files.size(), FileBytes(job.packed.package));
  fmt::print("package     {}\n", job.packed.digest.Hex());
  fmt::print("read in     {:.3f} s\n", scene.load_seconds);
}

// What an accelerator does not report is null.
nlohmann::ordered_json ToJson(const AcceleratorSummary& accelerator) {
  nlohmann::ordered_json json;
  json["kind"] = accelerator.kind;
  if (!accelerator.refusal.empty()) {
    json["refusal"] = accelerator.refusal;
    return json;
  }
  json["build_seconds"] = accelerator.build_seconds;
  json["bytes"] = accelerator.bytes;
  json["nodes"] = nullptr;
  json["surface_area_cost"] = nullptr;
  if (accelerator.nodes > 0) json["nodes"] = accelerator.nodes;
  if (accelerator.surface_area_cost > 0) json["surface_area_cost"] = accelerator.surface_area_cost;
  return json;
}

void PrintJson(const SceneJob& job) {
  const SceneSummary& scene = job.scene->summary();
  const FrameSpec& frame = job.packed.frames[0].spec;
  nlohmann::ordered_json json;
  json["frames"] = job.frames.size();
  json["width"] = frame.width;
  json["height"] = frame.height;
  json["crop"] = {frame.crop.x0, frame.crop.x1, frame.crop.y0, frame.crop.y1};
  json["samples_per_pixel"] = frame.samples_per_pixel;
  json["camera"] = scene.camera;
  json["film"] = scene.film;
  json["filter"] = scene.filter;
  json["sampler"] = scene.sampler;
  json["integrator"] = scene.integrator;
  json["accelerator"] = scene.accelerator;
  json["shapes"] = scene.shapes;
  for (const PrimitiveTotal& total : scene.primitives) json[total.name] = total.count;
  json["groups"] = scene.groups;
  json["instances"] = scene.instances;
  json["moving"] = scene.moving;
  json["lights"] = scene.lights;
  json["materials"] = scene.materials;
  json["textures"] = scene.textures;
  json["media"] = scene.media;
  json["geometry_bytes"] = scene.geometry_bytes;
  json["image_bytes"] = scene.image_bytes;
  json["package"] = job.packed.digest.Hex();
  json["load_seconds"] = scene.load_seconds;
  json["accelerators"] = nlohmann::ordered_json::array();
  for (const AcceleratorSummary& accelerator : scene.accelerators) {
    json["accelerators"].push_back(ToJson(accelerator));
  }
  json["warnings"] = scene.warnings;
  json["files"] = nlohmann::ordered_json::array();
  for (const auto& [path, file] : job.packed.package.files) {
    json["files"].push_back({{"path", path}, {"size", file.size}, {"sha256", file.digest.Hex()}});
  }
  fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

Result<int> RunInfo(const InfoOptions& options, Cancellation& cancellation) {
  if (IsPictureFile(options.scene.path)) {
    if (auto printed = PrintPictureInfo(options.scene.path, options.json); !printed) return printed.error();
    return 0;
  }
  const auto job = LoadSceneJob(options.scene, Scene::Depth::kSurvey, cancellation.token());
  if (!job) return job.error();
  if (options.json) {
    PrintJson(*job);
  } else {
    PrintText(*job);
  }
  return 0;
}

}  // namespace

Command InfoCommand() {
  return MakeCommand<InfoOptions>({
      .name = "info",
      .summary = "Describe a scene and list what differs from what it asks for, or describe an .exr picture",
      .examples = {{"Describe a scene", "tessera info scene.pbrt"},
                   {"Show the layers and the header of a picture", "tessera info picture.exr"}},
      .add_flags = AddInfoFlags,
      .run = RunInfo,
  });
}

}  // namespace tessera
