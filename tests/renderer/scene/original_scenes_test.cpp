// The six scenes of the original ray tracer.
#include <gtest/gtest.h>

#include <algorithm>

#include "renderer/film/sample_range.h"
#include "renderer/scene/scene.h"
#include "tests/build_paths.h"

namespace tessera {
namespace {

constexpr int kOriginalSize = 40;         // pixels
constexpr uint32_t kOriginalSamples = 4;  // per pixel

std::unique_ptr<Scene> LoadOriginal(const std::string& name, const std::string& integrator,
                                    const std::string& accelerator) {
  DiskFileSource files(SourceDir() + "/tests/scenes/original");
  RenderOptions options;
  options.samples_per_pixel = kOriginalSamples;
  options.width = options.height = kOriginalSize;
  options.integrator = integrator;
  options.accelerator = accelerator;
  Result<std::unique_ptr<Scene>> scene = Scene::Load(files, name + ".pbrt", options, Scene::Depth::kRender);
  EXPECT_TRUE(scene.has_value()) << scene.error().message;
  return scene ? std::move(*scene) : nullptr;
}

std::vector<float> Sums(const std::string& name, const std::string& integrator,
                        const std::string& accelerator) {
  const std::unique_ptr<Scene> scene = LoadOriginal(name, integrator, accelerator);
  if (!scene) return {};
  RenderStatistics statistics;
  const auto tile =
      scene->Render({0, 0, kOriginalSize, kOriginalSize}, {}, {0, kOriginalSamples}, nullptr, &statistics);
  EXPECT_EQ(statistics.discarded_samples, 0u);
  return tile->sums;
}

class OriginalScene : public testing::TestWithParam<const char*> {};

TEST_P(OriginalScene, IsReadWithoutAWarning) {
  EXPECT_EQ(LoadOriginal(GetParam(), "", "embree")->summary().warnings, std::vector<std::string>{});
}

TEST_P(OriginalScene, IsTheSameToTheLastBitWithAndWithoutATree) {
  for (const char* integrator : {"volpath", "mixture", "simplevolpath"}) {
    const std::vector<float> of_list = Sums(GetParam(), integrator, "list");
    EXPECT_GT(*std::max_element(of_list.begin(), of_list.end()), 0) << integrator;
    EXPECT_EQ(of_list, Sums(GetParam(), integrator, "bvh")) << integrator;
  }
}

// Embree decides differently which of two surfaces a ray hits that meets both in one place; nothing else.
TEST_P(OriginalScene, IsTheSameWithEmbreeInAlmostAllPixels) {
  const std::vector<float> ours = Sums(GetParam(), "volpath", "bvh");
  const std::vector<float> of_embree = Sums(GetParam(), "volpath", "embree");
  ASSERT_EQ(ours.size(), of_embree.size());
  size_t same = 0;
  for (size_t i = 0; i < ours.size(); ++i) same += ours[i] == of_embree[i];
  EXPECT_GT(same, ours.size() * 99 / 100);
}

INSTANTIATE_TEST_SUITE_P(Six, OriginalScene,
                         testing::Values("earth", "perlin-spheres", "emissive-light", "cornell-box",
                                         "materials", "final"));

}  // namespace
}  // namespace tessera
