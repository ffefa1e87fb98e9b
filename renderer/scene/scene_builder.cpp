#include "renderer/scene/scene_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "renderer/description/motion.h"
#include "renderer/film/tile_limit.h"
#include "renderer/scene/gbuffer.h"
#include "renderer/scene/layers.h"
#include "renderer/scene/light_check.h"
#include "renderer/scene/summary.h"
#include "renderer/scene/version.h"
#include "renderer/util/release.h"
#include "renderer/util/seconds_since.h"

namespace tessera {
namespace {

AcceleratorSummary SummaryOf(std::string_view kind, const Accelerator& accelerator) {
  const AcceleratorStatistics statistics = accelerator.statistics();
  return {std::string(kind), statistics.build_seconds, statistics.nodes,
          statistics.bytes,  statistics.sah_cost,      {}};
}

bool HasShutter(const Entity& camera) {
  return std::ranges::any_of(camera.parameters, [](const Parameter& parameter) {
    return parameter.name == "shutteropen" || parameter.name == "shutterclose";
  });
}

Denoiser DenoiserOf(const RenderOptions& options) {
  return options.denoiser.value_or(options.denoise ? Denoiser::kRegression : Denoiser::kNone);
}

// Those that the options ask for; sets are not expanded.
std::set<std::string> LayersOf(const RenderOptions& options) {
  std::set<std::string> names = options.aovs;
  if (DenoiserOf(options) != Denoiser::kNone) names.insert("denoise");
  return names;
}

bool WantsMotion(const Entity& film, const RenderOptions& options) {
  std::set<std::string> names = LayersOf(options);
  for (const Parameter& parameter : film.parameters) {
    if (parameter.name == "layers") names.insert(parameter.strings.begin(), parameter.strings.end());
  }
  return ExpandLayers(names, true, false).contains("motion");
}

// The header of the picture: what its values depend on, and nothing that differs between runs.
std::map<std::string, std::string> HeaderAttributes(const Scene::Data& data,
                                                    const IntegratorChoice& integrator) {
  std::map<std::string, std::string> attributes{
      {kSoftwareAttribute, fmt::format("Tessera {}", kRelease)},
      {kVersionAttribute, kRelease},
      {"tessera:seed", std::to_string(data.sampler.seed)},
      {kSamplesAttribute, std::to_string(data.sampler.samples_per_pixel)},
      {kSamplerAttribute, data.summary.sampler},
      {"tessera:integrator", integrator.name},
      {"tessera:maxDepth", std::to_string(integrator.max_depth)},
      {"tessera:camera", data.summary.camera},
      {"tessera:filter", data.summary.filter}};
  if (data.frame.IsAdaptive())
    attributes["tessera:noiseThreshold"] = fmt::format("{}", data.frame.noise_threshold);
  return attributes;
}

}  // namespace

// A frame of a sequence is a moment unless the scene says for how long its shutter is open.
Result<void> SceneBuilder::SettleMotion(const std::string& name) {
  const Result<int> moving = CheckMotion(scene_);
  if (!moving) return moving.error();
  data_->summary.moving = static_cast<uint64_t>(*moving);
  const bool has_shutter = HasShutter(scene_.camera);
  const bool shows_way = options_.time && options_.time_step && WantsMotion(scene_.film, options_);
  moves_ = *moving > 0 && (!options_.time || has_shutter || shows_way);
  if (*moving == 0 || !options_.time) return {};
  if (has_shutter) {
    StartTimeAt(*options_.time, scene_);
    return {};
  }
  scene_.diagnostics.Warn(name,
                          "what moves is shown at the time of the frame, without motion blur: the camera has "
                          "neither \"shutteropen\" nor \"shutterclose\"");
  if (!shows_way) return StopMotion(*options_.time, scene_);
  // What moves is kept moving, for its way to the next frame.
  StartTimeAt(*options_.time, scene_);
  data_->is_moment = true;
  return {};
}

Result<void> SceneBuilder::ReadSettings(const std::string& name) {
  const Result<SceneOptions> scene_options = ReadSceneOptions(scene_, options_, scene_.diagnostics);
  if (!scene_options) return scene_options.error();
  wavefront_ = scene_options->wavefront;
  ScaleDisplacementEdges(scene_options->displacement_edge_scale, scene_);
  data_->pixel_jitter = !scene_options->disable_pixel_jitter;
  data_->wavelength_jitter = !scene_options->disable_wavelength_jitter;
  const Result<FilmSettings> film = ReadFilm(scene_.film, options_, scene_.diagnostics);
  if (!film) return film.error();
  if (Result<void> camera = ReadCamera(*film); !camera) return camera;
  if (Result<void> sampling = ReadSampling(*film, *scene_options); !sampling) return sampling;
  const Result<IntegratorChoice> integrator = ChooseIntegrator(scene_, options_, scene_.diagnostics);
  if (!integrator) return integrator.error();
  SetEstimator(*integrator, *scene_options);
  Result<LightGroups> groups = LightGroups::Read(scene_, options_.light_groups, scene_.diagnostics);
  if (!groups) return groups.error();
  data_->light_groups = *std::move(groups);
  if (Result<void> described = DescribeFrame(*film, *integrator); !described) return described;
  return BuildLitWorld(*integrator, name);
}

Result<void> SceneBuilder::ReadCamera(const FilmSettings& film) {
  Result<Camera> camera =
      Camera::Read(scene_.camera, scene_.camera_from_world, {film.width, film.height, film.diagonal_mm},
                   images_, scene_.diagnostics);
  if (!camera) return camera.error();
  data_->world.camera = *camera;
  data_->motion_times = {camera->shutter_open(), camera->shutter_close()};
  if (data_->is_moment) data_->motion_times.end = static_cast<float>(*options_.time_step);
  return {};
}

// The filter and the sampler.
Result<void> SceneBuilder::ReadSampling(const FilmSettings& film, const SceneOptions& scene_options) {
  Result<Filter> filter = Filter::Read(scene_.filter);
  if (!filter) return filter.error();
  data_->filter = std::move(*filter);
  std::optional<uint32_t> samples = options_.samples_per_pixel;
  if (options_.quick && !samples) samples = 1;
  const Result<SamplerSettings> sampler =
      ReadSampler(scene_.sampler, film.width, film.height, {samples, options_.seed}, scene_options.seed,
                  scene_.diagnostics);
  if (!sampler) return sampler.error();
  data_->sampler = *sampler;
  data_->summary.extendable = !data_->sampler.sampler.DependsOnCount();
  return {};
}

void SceneBuilder::SetEstimator(const IntegratorChoice& integrator, const SceneOptions& scene_options) {
  // If samples can be added later the spacing must not depend on their number: the finest is used.
  constexpr float kSpacingMin = 0.125f;
  const float spacing = data_->summary.extendable
                            ? kSpacingMin
                            : 1 / std::sqrt(static_cast<float>(data_->sampler.samples_per_pixel));
  data_->footprint_scale = std::max(kSpacingMin, spacing);
  const float footprint = scene_options.disable_texture_filtering ? 0 : data_->footprint_scale;
  data_->estimator.integrator = integrator.integrator;
  data_->estimator.path = {integrator.max_depth, footprint, integrator.regularize,
                           scene_options.force_diffuse};
  data_->estimator.techniques = {integrator.sample_lights, integrator.sample_bsdf};
}

// The world, with its lights in their groups and as far as the integrator finds them.
Result<void> SceneBuilder::BuildLitWorld(const IntegratorChoice& integrator, const std::string& name) {
  const Result<std::vector<EmittingShape>> emitters = BuildNamedWorld(integrator, name);
  if (!emitters) return emitters.error();
  const World& world = data_->world;
  Estimator& estimator = data_->estimator;
  data_->light_groups.Assign(world, *emitters);
  if (world.has_subsurface && !estimator.integrator.has_subsurface) {
    scene_.diagnostics.Warn(
        scene_.integrator.location,
        fmt::format("\"subsurface\" materials are clear glass for integrator \"{}\", as in "
                    "pbrt; \"volpath\" scatters light in them",
                    integrator.name));
  }
  if (estimator.integrator.draws_rays_to_lights) estimator.lights.emplace(world);
  return CheckLightsFor(estimator, scene_, *emitters, world, scene_.diagnostics);
}

// `counts_levels`: the scene or the options have a number of Cryptomatte levels.
void SceneBuilder::WarnOfEmptyLayers(const std::set<std::string>& layers, const IntegratorChoice& integrator,
                                     bool counts_levels) {
  if (counts_levels && !HasMattes(layers))
    scene_.diagnostics.Warn(scene_.film.location,
                            "the number of Cryptomatte levels has no effect: the picture has no mattes");
  if (layers.contains("motion") && !moves_)
    scene_.diagnostics.Warn(scene_.film.location,
                            "layer \"motion\" is zero: nothing moves while the shutter is open");
  if (layers.contains(std::string(kLightGroupsLayer)) && !data_->light_groups.any())
    scene_.diagnostics.Warn(
        scene_.film.location,
        "layer \"light_groups\" has all light in the group \"others\": no light has a group");
  if (layers.contains("shadow") && !data_->estimator.HasShadowRays()) {
    scene_.diagnostics.Warn(
        scene_.integrator.location,
        fmt::format("layer \"shadow\" is black: integrator \"{}\" does not sample lights", integrator.name));
  }
}

// Of all machines alike: the pixels of an adaptive frame depend on its tiles.
void SceneBuilder::LimitTileSize() {
  FrameSpec& frame = data_->frame;
  const int largest = LargestTileSize(frame.Layout().shape());
  if (frame.tile_size <= largest) return;
  scene_.diagnostics.Warn(scene_.film.location,
                          fmt::format("tiles have {} instead of {} pixels on a side: with the layers of this "
                                      "frame, larger ones would exceed the limit of {} MB",
                                      largest, frame.tile_size, kTileBytesMax >> 20));
  frame.tile_size = largest;
}

Result<void> SceneBuilder::DescribeFrame(const FilmSettings& film, const IntegratorChoice& integrator) {
  Scene::Data& data = *data_;
  const ColorSpace* color_space = ColorSpace::Named(scene_.film_color_space);
  if (color_space == nullptr) return ErrorAt(scene_.film.location, "unknown colour space of the film");
  data.sensor = film.MakeSensor(*color_space, data.world.camera.exposure_time());
  data.frame.width = film.width;
  data.frame.height = film.height;
  data.frame.crop = film.crop;
  data.frame.samples_per_pixel = data.sampler.samples_per_pixel;
  data.frame.exr_type = film.exr_type;
  data.frame.SetNoiseThreshold(options_.noise_threshold);
  data.frame.denoiser = DenoiserOf(options_);
  data.frame.tile_size = options_.tile_size.value_or(kTileSizeDefault);
  data.layers = film.layers;
  data.layers.merge(LayersOf(options_));
  data.layers = ExpandLayers(data.layers, moves_, data.light_groups.any());
  if (!options_.light_groups.empty()) data.layers.emplace(kLightGroupsLayer);
  WarnOfEmptyLayers(data.layers, integrator, film.cryptomatte_levels.has_value());
  if (HasMattes(data.layers) && film.cryptomatte_levels)
    data.frame.cryptomatte_levels = *film.cryptomatte_levels;
  AddLayers(data.layers, data.frame.channels);
  if (data.layers.contains(std::string(kLightGroupsLayer)))
    data.light_groups.AddChannels(data.frame.channels);
  data.gbuffer = film.gbuffer;
  if (film.gbuffer != GbufferSpace::kNone) AddGbufferLayers(data.frame.channels);
  data.buckets = film.buckets;
  data.buckets.AddChannels(data.frame.channels);
  LimitTileSize();
  data.summary.camera = scene_.camera.kind;
  data.summary.film = scene_.film.kind;
  data.summary.filter = scene_.filter.kind;
  data.summary.sampler = scene_.sampler.kind;
  data.summary.integrator = integrator.name;
  data.frame.attributes = HeaderAttributes(data, integrator);
  data.buckets.AddAttributes(data.frame.attributes);
  data.frame_attributes.SetCamera(data.world.camera, film.width, film.height);
  data.frame_attributes.Set(options_, data.frame.attributes);
  return data.frame.Check();
}

// Names what the world holds if the picture has mattes.
Result<std::vector<EmittingShape>> SceneBuilder::BuildNamedWorld(const IntegratorChoice& integrator,
                                                                 const std::string& name) {
  Scene::Data& data = *data_;
  std::optional<SceneNames> names;
  if (HasMattes(data.layers)) names.emplace(scene_);
  const WorldRequest request{scene_,
                             files_,
                             images_,
                             integrator.light_sampler,
                             data.estimator.integrator.follows_media,
                             names ? &*names : nullptr,
                             options_.disable_image_textures};
  Result<std::vector<EmittingShape>> emitters = BuildWorld(request, &data.world, scene_.diagnostics);
  if (!emitters || !names) return emitters;
  data.mattes = MatteTable(*names, data.world.geometry);
  AddMatteNames(data.layers, data.mattes, name, scene_.diagnostics, data.frame.attributes);
  if (Result<void> good = data.frame.Check(); !good) return good.error();
  return emitters;
}

// A scene without light renders black, as in pbrt, except for its wavefront renderer, which refuses it.
Result<void> SceneBuilder::CheckLights(const std::string& name) {
  if (!data_->world.lights.empty() || data_->world.media.is_emissive()) return {};
  if (wavefront_)
    return BadInput(name + ": the scene asks for the wavefront renderer but has no light source");
  scene_.diagnostics.Warn(name, "the scene has no light source: every pixel will be black");
  return {};
}

Result<void> SceneBuilder::BuildAccelerator() {
  Scene::Data& data = *data_;
  Result<std::unique_ptr<Accelerator>> accelerator =
      MakeAccelerator(*accelerator_, data.world.geometry, data.world.textures);
  if (!accelerator) return accelerator.error();
  data.world.accelerator = std::move(*accelerator);
  data.summary.accelerators.push_back(SummaryOf(data.summary.accelerator, *data.world.accelerator));
  if (data.estimator.integrator.has_shadow_rays)
    data.estimator.visibility = std::make_unique<LightVisibility>(data.world);
  data.estimator.plain = std::make_unique<const PlainSurfaces>(data.world);
  return {};
}

void SceneBuilder::SurveyAccelerators() {
  Scene::Data& data = *data_;
  const bool all = options_.accelerator.empty();
  for (const Kind<AcceleratorMaker>& kind : Accelerators().kinds()) {
    if (!all && &kind != accelerator_) continue;
    const auto accelerator = MakeAccelerator(kind, data.world.geometry, data.world.textures);
    AcceleratorSummary summary{.kind = std::string(kind.name), .refusal = {}};
    if (accelerator) {
      summary = SummaryOf(kind.name, **accelerator);
    } else {
      summary.refusal = accelerator.error().message;
    }
    data.summary.accelerators.push_back(std::move(summary));
  }
}

Result<std::unique_ptr<Scene::Data>> SceneBuilder::Build(const std::string& name, Scene::Depth depth) {
  const auto start = std::chrono::steady_clock::now();
  data_->frame_attributes = FrameAttributes(scene_);
  if (Result<void> settled = SettleMotion(name); !settled) return settled.error();
  if (Result<void> settings = ReadSettings(name); !settings) return settings.error();
  if (Result<void> lit = CheckLights(name); !lit) return lit.error();
  const auto accelerator = ChooseAccelerator(scene_.accelerator, options_.accelerator);
  if (!accelerator) return accelerator.error();
  accelerator_ = *accelerator;
  data_->summary.accelerator = accelerator_->name;
  Summarize(scene_, data_->world, images_, &data_->summary);
  data_->summary.load_seconds = SecondsSince(start);
  if (depth == Scene::Depth::kRender) {
    if (Result<void> built = BuildAccelerator(); !built) return built.error();
  }
  if (depth == Scene::Depth::kSurvey) SurveyAccelerators();
  data_->summary.warnings = scene_.diagnostics.WarningTexts();
  return std::move(data_);
}

}  // namespace tessera
