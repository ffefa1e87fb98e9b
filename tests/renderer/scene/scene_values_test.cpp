// Scenes that are made of values, as readers of other languages than pbrt's make them.
#include <gtest/gtest.h>

#include <bit>

#include "renderer/description/description_builder.h"
#include "renderer/scene/scene.h"
#include "tests/renderer/memory_files.h"

namespace tessera {
namespace {

// A picture of 2 x 2 pixels, as a PFM of big-endian floats.
std::string FourColours() {
  std::string file = "PF\n2 2\n1.0\n";
  for (const float value : {.9f, .1f, .1f, .1f, .9f, .1f, .1f, .1f, .9f, .5f, .5f, .5f}) {
    const auto bits = std::bit_cast<uint32_t>(value);
    for (int shift = 24; shift >= 0; shift -= 8) file += static_cast<char>(bits >> shift & 0xff);
  }
  return file;
}

Parameter Floats(std::string type, std::string name, std::vector<float> values) {
  Parameter parameter;
  parameter.type = std::move(type);
  parameter.name = std::move(name);
  parameter.floats = std::move(values);
  return parameter;
}

Parameter Integer(std::string name, int value) {
  Parameter parameter;
  parameter.type = "integer";
  parameter.name = std::move(name);
  parameter.integers = {value};
  return parameter;
}

Parameter Word(std::string type, std::string name, std::string value) {
  Parameter parameter;
  parameter.type = std::move(type);
  parameter.name = std::move(name);
  parameter.strings = {std::move(value)};
  return parameter;
}

// A square of two triangles at z = 3.
MeshData Square() {
  return {{{-2, -2, 3}, {2, -2, 3}, {2, 2, 3}, {-2, 2, 3}},
          {},
          {},
          {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
          {0, 1, 2, 0, 2, 3}};
}

ShapeDescription ShapeOf(const std::string& kind, MeshData mesh) {
  ShapeDescription shape;
  shape.entity = {"Shape", kind, {}, {}};
  shape.mesh = std::make_shared<const MeshData>(std::move(mesh));
  return shape;
}

// The scene of kText below, with its image in itself.
void FillScene(DescriptionBuilder& builder) {
  SceneDescription& scene = builder.scene();
  scene.film = {"Film", "rgb", {}, {Integer("xresolution", 16), Integer("yresolution", 16)}};
  scene.camera = {"Camera", "perspective", {}, {Floats("float", "fov", {60})}};
  scene.sampler = {"Sampler", "independent", {}, {Integer("pixelsamples", 4)}};
  scene.integrator = {"Integrator", "path", {}, {}};
  scene.embedded_files["image0.pfm"] = std::make_shared<const std::string>(FourColours());
  builder.AddLight({{"LightSource", "infinite", {}, {Floats("rgb", "L", {1, 1, 1})}}, {}, ""});
  ShapeDescription patch =
      ShapeOf("bilinearmesh", {{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}, {1, 1, 2.5f}}, {}, {}, {}, {0, 1, 2, 3}});
  patch.world_from_object = AnimatedTransform(Translate({0, -.5f, 0}));
  builder.AddShape(std::move(patch), {});
  builder.AddTexture(
      {"picture", true, {"Texture", "imagemap", {}, {Word("string", "filename", "image0.pfm")}}, {}});
  builder.AddMaterial({"", {"Material", "diffuse", {}, {Word("texture", "reflectance", "picture")}}});
  ShapeDescription square = ShapeOf("trianglemesh", Square());
  square.material.index = 1;
  builder.AddShape(std::move(square), {});
}

constexpr const char* kText = R"(
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
Camera "perspective" "float fov" 60
Sampler "independent" "integer pixelsamples" 4
Integrator "path"
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Shape "bilinearmesh" "point3 P" [ 0 -.5 2  1 -.5 2  0 .5 2  1 .5 2.5 ]
Texture "picture" "spectrum" "imagemap" "string filename" "file.pfm"
Material "diffuse" "texture reflectance" "picture"
Shape "trianglemesh" "point3 P" [ -2 -2 3  2 -2 3  2 2 3  -2 2 3 ] "point2 uv" [ 0 0  1 0  1 1  0 1 ]
  "integer indices" [ 0 1 2 0 2 3 ]
)";

RadianceTile Render(const Result<std::unique_ptr<Scene>>& scene) {
  EXPECT_TRUE(scene) << scene.error().message;
  return *(*scene)->Render({0, 0, 16, 16}, {}, {0, 4}, nullptr);
}

TEST(SceneValues, RenderAsTheSameSceneInText) {
  MemoryFiles no_files, files({{"scene.pbrt", kText}, {"file.pfm", FourColours()}});
  DescriptionBuilder builder("scene.values");
  FillScene(builder);
  Result<SceneDescription> description = builder.Finish();
  ASSERT_TRUE(description) << description.error().message;
  const auto values =
      Scene::Build(*std::move(description), no_files, "scene.values", {}, Scene::Depth::kRender);
  const auto text = Scene::Load(files, "scene.pbrt", {}, Scene::Depth::kRender);
  const RadianceTile tile = Render(values);
  EXPECT_EQ(tile, Render(text));
  EXPECT_NE(tile.sums.front(), tile.sums[tile.sums.size() / 2]);
  EXPECT_EQ(no_files.reads, 0);
}

// What is wrong with a scene of this mesh.
std::string ErrorOf(const std::string& kind, MeshData mesh) {
  DescriptionBuilder builder("scene.values");
  builder.AddShape(ShapeOf(kind, std::move(mesh)), {});
  MemoryFiles files;
  const auto scene = Scene::Build(*builder.Finish(), files, "scene.values", {}, Scene::Depth::kCheck);
  return scene ? "" : scene.error().message;
}

TEST(SceneValues, BadMeshesAreRefused) {
  MeshData mesh = Square();
  mesh.indices.back() = 4;
  EXPECT_EQ(ErrorOf("trianglemesh", mesh),
            "<scene>:1:1: index 4 of the mesh is out of range: it has 4 points");
  mesh = Square();
  mesh.indices.pop_back();
  EXPECT_EQ(ErrorOf("trianglemesh", mesh), "<scene>:1:1: the mesh has 5 indices, expected a multiple of 3");
  mesh = Square();
  mesh.uv.pop_back();
  EXPECT_EQ(ErrorOf("trianglemesh", mesh), "<scene>:1:1: the mesh has 4 points but 3 \"uv\"");
  EXPECT_EQ(ErrorOf("sphere", Square()), "<scene>:1:1: shape \"sphere\" does not take a mesh");
}

}  // namespace
}  // namespace tessera
