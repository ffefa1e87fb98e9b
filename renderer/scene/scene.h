// The renderer as the programs see it: a scene file in, radiance tiles out.
#pragma once

#include <array>
#include <atomic>
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

namespace tessera {

// Further channels that a picture may get.
std::vector<std::string_view> AovNames();

// What the command line may override of a scene (DESIGN.md section 8).
struct RenderOptions {
  std::optional<uint32_t> samples_per_pixel;
  std::optional<int> width, height;
  std::optional<std::array<float, 4>> crop;  // x0, x1, y0, y1 as fractions
  std::optional<uint64_t> seed;
  std::optional<double>
      time;  // seconds: the moment that is seen of what moves; the middle of the shutter without
  std::string integrator;   // empty: the scene's
  std::string accelerator;  // empty: "embree"
  std::optional<int> max_depth;
  std::optional<int> tile_size;
  std::optional<ExrType> exr_type;
  double noise_threshold = 0;  // FrameSpec::noise_threshold
  std::set<std::string> aovs;  // of AovNames

  bool operator==(const RenderOptions&) const = default;
};

// One codec for jobs and journals: text of key=value lines, sorted.
std::string EncodeRenderOptions(const RenderOptions& options);
Result<RenderOptions> DecodeRenderOptions(const std::string& text);

// An accelerator that was built over a scene.
struct AcceleratorSummary {
  std::string kind;
  double build_seconds = 0;
  uint64_t nodes = 0, bytes = 0;  // 0 nodes: none, or it does not tell
  double surface_area_cost = 0;   // 0: it does not tell
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
  uint64_t moving = 0;  // the camera, shapes and instances that are elsewhere at another time
  uint64_t geometry_bytes = 0, image_bytes = 0;
  double load_seconds = 0;
  // Whether a pixel's samples are the first of those it would have with more samples per pixel.
  bool extendable = false;
  std::vector<AcceleratorSummary> accelerators;  // those that were built
  std::vector<std::string> warnings;             // what is done otherwise than the scene asks
};

// What rendering some units took.
struct RenderStatistics {
  uint64_t camera_rays = 0, bounce_rays = 0, shadow_rays = 0;
  uint64_t discarded_samples = 0;  // not finite: counted as black

  uint64_t rays() const { return camera_rays + bounce_rays + shadow_rays; }
};

// A scene ready to render. Immutable: any number of threads may render from it.
class Scene {
 public:
  enum class Depth {
    kCheck,  // read and check everything, build no acceleration structure: cannot render
    kRender,
    kSurvey,  // as kCheck, but build every accelerator, or the one that was asked for, to tell of it
  };
  // Reads scene file `name` of `files` with all it refers to.
  static Result<std::unique_ptr<Scene>> Load(FileSource& files, const std::string& name,
                                             const RenderOptions& options, Depth depth);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // Of the scene and the options: the same on every machine. Its attributes hold settings, seed and software
  // version; the scene digest is the caller's to add.
  const FrameSpec& frame() const;
  const SceneSummary& summary() const;

  // Renders samples `range` of `pixels` of `bounds` on the calling thread: a pure function of the scene and
  // the unit. Nothing if `stop` became true first; stop may be null. Adds to `statistics` unless it is null.
  std::optional<RadianceTile> Render(PixelBounds bounds, const PixelMask& pixels, SampleRange range,
                                     const std::atomic<bool>* stop,
                                     RenderStatistics* statistics = nullptr) const;

  struct Data;  // scene_data.h

 private:
  explicit Scene(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

}  // namespace tessera
