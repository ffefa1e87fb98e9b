// The renderer as the programs see it: a scene file in, radiance tiles out.
#pragma once

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/description/file_source.h"
#include "renderer/film/frame_spec.h"
#include "renderer/film/pixel_mask.h"
#include "renderer/film/radiance_tile.h"
#include "renderer/scene/light_group_rule.h"

namespace tessera {

struct SceneDescription;

// Names of the layers that may be added to a picture, then those of sets of them.
std::vector<std::string_view> AovNames();

// What the command line may override of a scene (DESIGN.md section 8).
struct RenderOptions {
  std::optional<uint32_t> samples_per_pixel;
  std::optional<int> width, height;
  std::optional<std::array<float, 4>> crop;  // x0, x1, y0, y1 as fractions; excludes pixel_bounds
  // x0, x1, y0, y1; the ends are exclusive.
  std::optional<std::array<int, 4>> pixel_bounds;
  std::optional<uint64_t> seed;
  // Seconds: when the frame of an animated scene is. Added to the times of the shutter; a scene that gives
  // none shows this moment.
  std::optional<double> time;
  std::optional<double> time_step;  // seconds to the next frame of the sequence, for the layer "motion"
  std::string integrator;           // empty: the scene's
  std::string accelerator;          // empty: "embree"
  std::optional<int> max_depth;
  std::optional<int> tile_size;
  std::optional<ExrType> exr_type;
  // Of a sequence: the number of the frame and the rate, for the header of its picture.
  std::optional<int> frame;
  std::optional<double> frames_per_second;
  double noise_threshold = 0;  // FrameSpec::noise_threshold
  std::set<std::string> aovs;  // of AovNames
  // Denoise the frame when it is complete, with kRegression unless another is given, and add the layers that
  // this needs.
  bool denoise = false;
  std::optional<Denoiser> denoiser;
  std::optional<uint32_t> cryptomatte_levels;  // FrameSpec::cryptomatte_levels
  std::vector<LightGroupRule> light_groups;
  // Switch an Option of the scene on (SceneOptions).
  bool disable_pixel_jitter = false, disable_wavelength_jitter = false, disable_texture_filtering = false;
  bool force_diffuse = false;
  bool disable_image_textures = false;           // textures of images are their mean everywhere
  std::optional<float> displacement_edge_scale;  // replaces that of the scene
  // A draft: one sample per pixel and a quarter of the width and height, unless they are given.
  bool quick = false;

  bool operator==(const RenderOptions&) const = default;
};

// The one codec, for jobs and journals: sorted lines of key=value.
std::string EncodeRenderOptions(const RenderOptions& options);
Result<RenderOptions> DecodeRenderOptions(const std::string& text);

// An accelerator that was built over a scene.
struct AcceleratorSummary {
  std::string kind;
  double build_seconds = 0;
  uint64_t nodes = 0, bytes = 0;  // 0 nodes: none, or not reported by the kind
  double surface_area_cost = 0;   // 0: not reported by the kind
  std::string refusal;            // not empty: why this accelerator cannot hold the scene
};

// The primitives of one form of shape.
struct PrimitiveTotal {
  std::string name;  // plural: "triangles"
  uint64_t count = 0;
};

// What a scene holds, for `tessera info`.
struct SceneSummary {
  std::string camera, film, filter, sampler, integrator, accelerator;
  uint64_t shapes = 0, groups = 0, instances = 0;
  std::vector<PrimitiveTotal> primitives;  // of every form, also of those that the scene has none of
  uint64_t lights = 0, materials = 0, textures = 0, media = 0;
  uint64_t moving = 0;  // the camera, shapes, instances and lights that move
  uint64_t geometry_bytes = 0, image_bytes = 0;
  double load_seconds = 0;
  // Whether a pixel's samples are the first of those it would have with more samples per pixel.
  bool extendable = false;
  std::vector<AcceleratorSummary> accelerators;  // those that were built
  std::vector<std::string> warnings;             // what differs from what the scene asks for
};

// What it took to render units.
struct RenderStatistics {
  uint64_t camera_rays = 0, bounce_rays = 0, shadow_rays = 0;
  uint64_t discarded_samples = 0;  // not finite: counted as black

  uint64_t rays() const { return camera_rays + bounce_rays + shadow_rays; }
};

// A scene ready to render. Immutable: any number of threads may render from it.
class Scene {
 public:
  enum class Depth {
    kCheck,  // read and check everything, but build no accelerator: cannot render
    kRender,
    kSurvey,  // as kCheck, but build every accelerator, or the one of the options, for the summary
  };
  // Reads scene file `name` of `files` with all that it refers to.
  static Result<std::unique_ptr<Scene>> Load(FileSource& files, const std::string& name,
                                             const RenderOptions& options, Depth depth);
  // The same for a scene that was read before; `name` stands for its file in messages.
  static Result<std::unique_ptr<Scene>> Build(SceneDescription description, FileSource& files,
                                              const std::string& name, const RenderOptions& options,
                                              Depth depth);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // Follows from the scene and the options: the same on every machine. Its attributes hold settings, seed and
  // software version; the caller adds the scene digest.
  const FrameSpec& frame() const;
  const SceneSummary& summary() const;
  // Makes those attributes of this scene's frame that depend on the frame of a sequence those of the frame
  // that `options` describe. Nothing else but their number and time may differ from the options of this
  // scene.
  void SetFrameAttributes(const RenderOptions& options, std::map<std::string, std::string>& attributes) const;

  // Renders samples `range` of `pixels` of `bounds` on the calling thread: a pure function of the scene and
  // the unit. Returns nullopt if `stop`, which may be null, became true first. Adds to `statistics` unless
  // null.
  std::optional<RadianceTile> Render(PixelBounds bounds, const PixelMask& pixels, SampleRange range,
                                     const std::atomic<bool>* stop,
                                     RenderStatistics* statistics = nullptr) const;

  struct Data;  // scene_data.h

 private:
  explicit Scene(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

}  // namespace tessera
