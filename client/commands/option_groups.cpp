#include "client/commands/option_groups.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <tuple>

#include "client/commands/option_values.h"
#include "client/output/output_file.h"
#include "client/output/picture_format.h"
#include "proto/shell/program.h"
#include "renderer/accelerator/accelerator.h"
#include "renderer/film/adaptive.h"
#include "renderer/integrator/integrator_kinds.h"
#include "renderer/load/limited_load.h"

namespace tessera {
namespace {

constexpr int kPathDepthMax = 1'000'000;                     // bounces: more than any path survives
constexpr double kFramesPerSecondMin = 1e-3;                 // slower than any time lapse
constexpr double kEdgeScaleMin = 1e-6, kEdgeScaleMax = 1e6;  // beyond any use
constexpr int64_t kPatienceMax_s = 7 * 24 * 3600;
constexpr size_t kJobsWatchedMax = 64;  // each takes a connection and a thread

constexpr const char* kCoordinatorVariable = "TESSERA_COORDINATOR";
constexpr const char* kFarmVariable = "TESSERA_FARM";
constexpr const char* kCertificateVariable = "TESSERA_TLS_CERT";
constexpr const char* kKeyVariable = "TESSERA_TLS_KEY";
constexpr const char* kAuthorityVariable = "TESSERA_TLS_CA";

int64_t InSeconds(std::chrono::milliseconds duration) {
  return std::chrono::duration_cast<std::chrono::seconds>(duration).count();
}

void AddFrameFlags(CLI::App& app, SceneOptions& options) {
  AddValue(app, "--frames", "A-B[xSTEP]",
           "Render a sequence: one scene file per frame if SCENE has a place for the frame number "
           "(scene.####.pbrt), or the frames of one animated scene",
           options.frames, ParseFrameRange);
  AddValue(app, "--fps", "F",
           WithDefault("Frames per second of an animated scene; frame N shows it at N / fps seconds",
                       fmt::format("{}", options.fps)),
           options.fps, [](std::string_view flag, std::string_view word) {
             return ParseNumber(flag, word, kFramesPerSecondMin);
           });
}

void AddSamplingFlags(CLI::App& app, RenderOptions& render) {
  AddValue(app, "--spp", "N", "Samples per pixel; the maximum with --noise-threshold",
           render.samples_per_pixel, WholeNumber<uint32_t>(1, kSamplesPerPixelMax));
  AddValue(
      app, "--noise-threshold", "E",
      WithDefault(fmt::format("Stop sampling a pixel once the square root of its expected relMSE is below "
                              "E x sqrt(n / {}) at n samples; 0.2 is a draft, 0.05 is clean",
                              kThresholdSamples),
                  "0, every pixel gets all samples"),
      render.noise_threshold, [](std::string_view flag, std::string_view word) {
        return ParseNumber(flag, word, 0, kNoiseThresholdMax);
      });
  AddValue(app, "--seed", "S", "Random seed", render.seed, WholeNumber<uint64_t>(0));
  AddText(app, "--integrator", "NAME", fmt::format("Integrator: {}", fmt::join(Integrators().Names(), ", ")),
          render.integrator);
  const std::vector<std::string_view> accelerators = Accelerators().Names();
  AddValue(app, "--accelerator", "NAME",
           WithDefault(fmt::format("Ray tracing structure: {}", fmt::join(accelerators, ", ")),
                       std::string(accelerators.front())),
           render.accelerator, [accelerators](std::string_view flag, std::string_view word) {
             return ParseChoice(flag, word, accelerators);
           });
  AddValue(app, "--max-depth", "N", "Maximum path length in bounces", render.max_depth,
           WholeNumber<int>(0, kPathDepthMax));
}

// Flags of pbrt under the same names.
void AddDebugFlags(CLI::App& app, RenderOptions& render) {
  AddSwitch(app, "--quick", "Render a draft: a quarter of the width and height at 1 sample per pixel",
            render.quick);
  AddSwitch(app, "--disable-image-textures", "Show textures of images as their mean",
            render.disable_image_textures);
  AddSwitch(app, "--disable-pixel-jitter", "Sample the centres of pixels and of the lens",
            render.disable_pixel_jitter);
  AddSwitch(app, "--disable-wavelength-jitter", "Give all samples the same wavelengths",
            render.disable_wavelength_jitter);
  AddSwitch(app, "--disable-texture-filtering", "Look textures up at points",
            render.disable_texture_filtering);
  AddSwitch(app, "--force-diffuse", "Make all surfaces diffuse, with the albedo of their material",
            render.force_diffuse);
  AddValue(app, "--displacement-edge-scale", "F",
           "Multiply the edge length of displaced meshes; below 1 is finer", render.displacement_edge_scale,
           [](std::string_view flag, std::string_view word) -> Result<float> {
             const auto scale = ParseNumber(flag, word, kEdgeScaleMin, kEdgeScaleMax);
             if (!scale) return scale.error();
             return static_cast<float>(*scale);
           });
}

void AddFilmFlags(CLI::App& app, RenderOptions& render) {
  const auto set_size = [&render](const std::string& word) -> Result<void> {
    const auto size = ParseResolution("--resolution", word);
    if (!size) return size.error();
    std::tie(render.width, render.height) = *size;
    return {};
  };
  AddWord(app, "--resolution", "WxH", "Size of the picture in pixels", set_size);
  AddValue(app, "--crop", "x0,x1,y0,y1", "Part of the picture to render, as fractions of its size",
           render.crop, ParseCrop);
  AddValue(app, "--pixelbounds", "x0,x1,y0,y1",
           "Part of the picture to render, in pixels, in place of --crop; x1 and y1 are exclusive",
           render.pixel_bounds, ParsePixelBounds);
  AddValue(app, "--tile-size", "N",
           WithDefault("Side of a tile in pixels", fmt::format("{}", kTileSizeDefault)), render.tile_size,
           WholeNumber<int>(1, kTileSizeMax));
  AddValue(app, "--exr-type", "TYPE",
           WithDefault("Type of the values in the EXR file: half or float", "half"), render.exr_type,
           ParseExrType);
  AddValue(app, "--aov", "LIST",
           fmt::format("Layers to add to the picture, separated by commas: {}", fmt::join(AovNames(), ", ")),
           render.aovs,
           [](std::string_view flag, std::string_view word) { return ParseNames(flag, word, AovNames()); });
  AddValue(
      app, "--cryptomatte-levels", "N",
      WithDefault(fmt::format("Levels of the mattes, 1 to {}: each holds two ids of a pixel; Blender and "
                              "Arnold count the ids",
                              kCryptomatteLevelsMax),
                  fmt::format("{}", kCryptomatteLevelsDefault)),
      render.cryptomatte_levels, WholeNumber<uint32_t>(1, kCryptomatteLevelsMax));
  AddSwitch(
      app, "--denoise",
      "Denoise the picture when it is complete and keep the noisy colours in the layer noisy; adds --aov "
      "denoise",
      render.denoise);
  AddValue(app, "--denoiser", "NAME",
           WithDefault(
               "Denoise as --denoise, with the denoiser NAME: regression, or oidn (Open Image Denoise, if it "
               "is installed)",
               "regression"),
           render.denoiser, ParseDenoiser);
  AddRepeatedWord(
      app, "--light-group", "NAME=PATTERN",
      "Add the light of this group as a layer: the lights whose kind (point, area, ...), material or "
      "FILE:LINE:COLUMN matches, where * stands for any text; tessera relight mixes groups",
      kLightGroupsMax, [&render](const std::string& word) -> Result<void> {
        auto rule = ParseLightGroupRule(word);
        if (!rule) return BadInput("--light-group: " + rule.error().message);
        render.light_groups.push_back(*std::move(rule));
        return {};
      });
}

// A flag of the command line's contract that is not implemented yet is refused by name, not as an unknown
// one.
void AddUnsupported(CLI::App& app, const std::string& name) {
  AddWord(app, name, "VALUE", "",
          [name](const std::string&) -> Result<void> { return BadInput(name + " is not supported yet"); });
  app.get_option(name)->group("");  // hides it from the help
}

}  // namespace

void AddSceneFlags(CLI::App& app, SceneOptions& options) {
  AddText(app, "SCENE", "", "Scene file (pbrt-v4); - is standard input", options.path, Presence::kRequired);
  AddFrameFlags(app, options);
  AddSamplingFlags(app, options.render);
  AddFilmFlags(app, options.render);
  AddDebugFlags(app, options.render);
  AddUnsupported(app, "--camera");
}

void AddSceneMemoryFlag(CLI::App& app, SceneOptions& options, const std::string& description,
                        const std::string& default_text) {
  AddWord(app, "--scene-memory", "SIZE", WithDefault(description, default_text),
          [&options](const std::string& word) -> Result<void> {
            const auto size = ParseSize("--scene-memory", word, kSceneMemoryMin);
            if (!size) return size.error();
            options.scene_memory = *size;
            return {};
          });
}

void AddSceneMemoryFlag(CLI::App& app, SceneOptions& options) {
  AddSceneMemoryFlag(app, options,
                     "Memory that loading one scene may take in this command; a scene that needs more fails",
                     "all of that of the machine or its control group");
}

void AddRequiredSamples(CLI::App& app, uint32_t& samples_per_pixel) {
  AddValue(app, "--spp", "N", "Samples per pixel in total", samples_per_pixel,
           WholeNumber<uint32_t>(1, kSamplesPerPixelMax), Presence::kRequired);
}

void AddTlsFlags(CLI::App& app, TlsFiles& files) {
  files = {Environment(kCertificateVariable), Environment(kKeyVariable), Environment(kAuthorityVariable)};
  AddText(
      app, "--tls-cert", "FILE",
      WithDefault("Use this certificate of an organisation in place of a login; needs --tls-key and --tls-ca",
                  fmt::format("${}", kCertificateVariable)),
      files.certificate);
  AddText(app, "--tls-key", "FILE", WithDefault("Key of that certificate", fmt::format("${}", kKeyVariable)),
          files.key);
  AddText(app, "--tls-ca", "FILE",
          WithDefault("Certificates that the coordinator's must be issued by",
                      fmt::format("${}", kAuthorityVariable)),
          files.authority);
}

void AddConnectionFlags(CLI::App& app, ConnectionOptions& options) {
  options.farm.coordinator = Environment(kCoordinatorVariable);
  options.farm.farm = Environment(kFarmVariable);
  AddText(app, "--coordinator", "ADDR",
          WithDefault(
              "Address of the coordinator: HOST:PORT or unix:PATH",
              fmt::format("${}, that of the last login, or {}", kCoordinatorVariable, kCoordinatorDefault)),
          options.farm.coordinator);
  AddText(app, "--farm", "NAME", WithDefault("Use the login of this name", fmt::format("${}", kFarmVariable)),
          options.farm.farm);
  AddTlsFlags(app, options.farm.tls);
  AddSwitch(app, "--insecure", "Connect without encryption, to a coordinator on this machine alone",
            options.farm.insecure);
  AddValue(app, "--patience", "N",
           WithDefault("Seconds to wait for a coordinator that does not answer or asks to try again later",
                       fmt::format("{}, and {} once connected", InSeconds(options.patience.connection),
                                   InSeconds(options.patience.calls))),
           options.patience, [](std::string_view flag, std::string_view word) -> Result<Patience> {
             const auto seconds = ParseInteger(flag, word, 0, kPatienceMax_s);
             if (!seconds) return seconds.error();
             return Patience{std::chrono::seconds(*seconds), std::chrono::seconds(*seconds)};
           });
}

void AddOutputFlags(CLI::App& app, OutputOptions& options, const std::string& default_name) {
  AddText(
      app, "-o,--output", "FILE",
      WithDefault("Picture file to write: .exr .png .jpg .tif .hdr or .pfm, or - for OpenEXR on the standard "
                  "output; in the name for a sequence, #### stands for the frame number",
                  default_name),
      options.picture);
  AddSwitch(app, "--aov-split", "Write each layer to a file of its own, FILE with its name before .exr",
            options.exr.splits_layers);
  AddValue(app, "--compression", "NAME",
           WithDefault(fmt::format("Compression of .exr files: {}", fmt::join(ExrCompressionNames(), ", ")),
                       "zip"),
           options.exr.compression, ParseCompression);
  AddValue(app, "--exr-layout", "LAYOUT",
           WithDefault("Order of the pixels in .exr files: scanlines or tiles", "scanlines"),
           options.exr.layout, ParseExrLayout);
  AddSwitch(app, "--thumbnail", "Add a small picture to the header of .exr files, for file managers",
            options.exr.has_preview);
  AddText(app, "--png", "FILE", "Also write a tone-mapped 8-bit PNG; - is the standard output", options.png);
  AddSwitch(app, "--no-clobber", "Refuse to start if a picture would replace a file", options.no_clobber);
}

bool TakesStandardOutput(const OutputOptions& options) {
  return IsStandardOutput(options.picture) || IsStandardOutput(options.png);
}

Result<void> CheckPictureOptions(const RenderOptions& render, const OutputOptions& output) {
  if (output.picture.empty() || (render.aovs.empty() && render.light_groups.empty())) return {};
  const auto format = PictureFormatOf(output.picture);
  if (!format) return format.error();
  if (*format == PictureFormat::kExr) return {};
  return BadInput(fmt::format("{}: the layers of --aov and --light-group can only be written to an .exr file",
                              output.picture));
}

namespace {

constexpr const char* kJobHelp = "Job id, as printed by submit and listed by jobs";
constexpr const char* kDefaultJob = "your only open job, or your last one if none is open";

Result<JobId> ParseJob(std::string_view flag, std::string_view word) {
  const auto number = ParseUnsigned(flag, word, 1);
  if (!number)
    return BadInput(fmt::format("{}: \"{}\" is not the id of a job; tessera jobs lists them", flag, word));
  return JobId{*number};
}

}  // namespace

void AddJobArgument(CLI::App& app, JobId& job) {
  AddValue(app, "JOB", "", kJobHelp, job, ParseJob, Presence::kRequired);
}

void AddDefaultJobArgument(CLI::App& app, std::optional<JobId>& job) {
  AddValue(app, "JOB", "", WithDefault(kJobHelp, kDefaultJob), job, ParseJob);
}

void AddJobsArgument(CLI::App& app, std::vector<JobId>& jobs) {
  const auto add = [&jobs](const std::vector<std::string>& words) {
    for (const std::string& word : words) {
      const auto job = ParseJob("JOB", word);
      if (!job) throw CLI::ValidationError(job.error().message);
      if (std::ranges::find(jobs, *job) == jobs.end()) jobs.push_back(*job);
    }
    if (jobs.size() > kJobsWatchedMax)
      throw CLI::ValidationError(fmt::format("JOB: more than {} jobs", kJobsWatchedMax));
  };
  app.add_option_function<std::vector<std::string>>(
         "JOB", add, WithDefault(std::string(kJobHelp) + "; may be repeated", kDefaultJob))
      ->type_name("");
}

void AddDryRunFlag(CLI::App& app, bool& dry_run) {
  AddSwitch(app, "--dry-run",
            "Only print what would be sent and rendered, with time and memory estimated from a short probe",
            dry_run);
}

void AddNotifyFlag(CLI::App& app, std::string& command) {
  AddText(app, "--notify-command", "COMMAND",
          "Run this with sh at the end of a job; it finds $TESSERA_JOB_ID, $TESSERA_JOB_NAME, "
          "$TESSERA_JOB_STATE and "
          "$TESSERA_JOB_REASON",
          command);
}

void AddJsonFlag(CLI::App& app, bool& json) {
  AddSwitch(app, "--json", "Print the answer as JSON", json);
}

void AddFirstFlag(CLI::App& app, std::optional<Region>& first) {
  AddValue(app, "--first", "x0,x1,y0,y1",
           "Part of the picture to render before the rest, as fractions of its size; the picture is the same",
           first, [](std::string_view flag, std::string_view word) -> Result<Region> {
             const auto sides = ParseCrop(flag, word);
             if (!sides) return sides.error();
             const auto [x0, x1, y0, y1] = *sides;
             return Region{x0, x1, y0, y1};
           });
}

Result<void> CheckFirst(const std::optional<Region>& first, const std::vector<FrameRequest>& frames) {
  const auto is_rendered = [&](const FrameRequest& frame) {
    return Overlap(frame.spec.crop, PixelsOf(*first, frame.spec));
  };
  if (!first || std::ranges::any_of(frames, is_rendered)) return {};
  return BadInput("--first: nothing of that part is rendered: the picture is cropped to another one");
}

void AddVerifyFlag(CLI::App& app, double& share) {
  AddValue(
      app, "--verify", "P%",
      WithDefault("Render this share of the work on two workers and compare the results bit for bit", "0%"),
      share, ParsePercent);
}

}  // namespace tessera
