// Each kind of shape, camera, medium, material, motion, sampler, film, filter, light and integrator has a
// picture of its own, which is bit-identical for any number of workers, threads and tiles and in every
// accelerator.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <iterator>

#include "tests/build_paths.h"
#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

struct KindScene {
  const char* name;
  const char* settings;  // before WorldBegin
  const char* world;     // what stands in the middle
};

constexpr const char* kBall = "Shape \"sphere\"\n";

constexpr KindScene kScenes[] = {
    // Shapes. A row without settings has those of kHead.
    {"sphere", "", "Shape \"sphere\" \"float zmin\" -0.6 \"float zmax\" 0.8 \"float phimax\" 300"},
    {"disk", "", "Shape \"disk\" \"float innerradius\" 0.3 \"float phimax\" 250"},
    {"cylinder", "", "Rotate 70 1 1 0 Shape \"cylinder\" \"float radius\" 0.7 \"float phimax\" 200"},
    {"bilinearmesh", "", "Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 0  1 -1 0.7  -1 1 0.5  1 1 -0.6 ]"},
    {"trianglemesh with alpha", "",
     "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0  1 -1 0  0 1 -0.4 ] \"float alpha\" 0.6"},
    {"plymesh", "", "Shape \"plymesh\" \"string filename\" \"mesh.ply\""},
    {"displaced plymesh", "",
     "Texture \"d\" \"float\" \"wrinkled\" Shape \"plymesh\" \"string filename\" \"quad.ply\" "
     "\"texture displacement\" \"d\" \"float edgelength\" 0.3"},
    {"loopsubdiv", "",
     "Shape \"loopsubdiv\" \"integer levels\" 2 \"integer indices\" [ 0 1 2  0 3 1  0 2 3  1 3 2 ] "
     "\"point3 P\" [ 0 1 0  1 -0.6 0.7  -1 -0.6 0.7  0 -0.6 -1 ]"},
    {"flat curve", "",
     "Shape \"curve\" \"float width\" 0.3 \"point3 P\" [ -1 -1 0  0 1 -1  0.5 -1 1  1 1 0 ]"},
    {"cylindrical curve of hair", "",
     "Material \"hair\" \"float eumelanin\" 0.4 Shape \"curve\" \"string type\" \"cylinder\" \"string "
     "basis\" "
     "\"bspline\" \"float width0\" 0.4 \"float width1\" 0.05 "
     "\"point3 P\" [ -2 -1 0  -0.5 -1 0  0.4 1 0.3  1 0 0  1.2 2 0 ]"},
    {"ribbon", "",
     "Shape \"curve\" \"string type\" \"ribbon\" \"integer degree\" 2 \"float width\" 0.5 \"normal N\" "
     "[ 0 0 -1  1 0 -1 ] \"point3 P\" [ -1 -1 0  0 1.5 0  1 -1 0 ]"},
    {"instances", "",
     "ObjectBegin \"o\" Shape \"sphere\" \"float radius\" 0.5 Shape \"disk\" ObjectEnd ObjectInstance \"o\" "
     "Translate 1 0.5 0 Rotate 30 1 2 3 Scale 1 -0.5 1 ObjectInstance \"o\""},
    // Visibility and light links
    {"hidden shapes and linked lights", "",
     "Shape \"sphere\" \"float radius\" 0.7 \"bool visible_camera\" false Translate 1 0 -0.5 "
     "Shape \"cylinder\" \"float radius\" 0.3 \"bool visible_shadow\" false Translate -2 0 0 "
     "Shape \"bilinearmesh\" \"string name\" \"card\" \"bool visible_indirect\" false "
     "\"point3 P\" [ -1 -1 0  1 -1 0.7  -1 1 0.5  1 1 -0.6 ] "
     "LightSource \"point\" \"point3 from\" [ 0 2 -2 ] \"string link_exclude\" \"card\" "
     "LightSource \"point\" \"point3 from\" [ 1 2 -2 ] \"bool cast_shadows\" false"},
    // Motion
    {"moving shape", "",
     "ActiveTransform EndTime Translate 1 0 0 Rotate 80 1 1 0 ActiveTransform All Shape \"cylinder\""},
    {"moving curve", "",
     "ActiveTransform EndTime Translate 0.5 0 0 ActiveTransform All Shape \"curve\" \"float width\" 0.3 "
     "\"point3 P\" [ -1 -1 0  0 1 -1  0.5 -1 1  1 1 0 ]"},
    {"moving instance", "",
     "ObjectBegin \"o\" Shape \"sphere\" Shape \"disk\" \"float radius\" 2 ObjectEnd "
     "ActiveTransform EndTime Rotate 60 1 1 0 Scale 0.5 1 1 ActiveTransform All ObjectInstance \"o\""},
    {"moving area light", "",
     "AreaLightSource \"diffuse\" \"rgb L\" [ 2 1 1 ] ActiveTransform EndTime Translate 0.5 1 0 "
     "ActiveTransform "
     "All Shape \"sphere\" \"float radius\" 0.4"},
    {"moving lights", "",
     "Shape \"sphere\" ActiveTransform EndTime Translate 1 0 0 Rotate 90 0 1 0 ActiveTransform All "
     "LightSource "
     "\"spot\" \"point3 from\" [ 0 4 -3 ] \"point3 to\" [ 0 0 0 ] \"rgb I\" [ 20 20 30 ] "
     "LightSource \"infinite\" \"string filename\" \"image.pfm\""},
    {"moving camera", "ActiveTransform EndTime Rotate 9 0 1 0 ActiveTransform All Camera \"perspective\"",
     kBall},
    // Cameras
    {"camera with a lens", "Camera \"perspective\" \"float lensradius\" 0.3 \"float focaldistance\" 4",
     kBall},
    {"orthographic", "Camera \"orthographic\" \"float screenwindow\" [ -2 2 -1.5 1.5 ]", kBall},
    {"spherical", "Camera \"spherical\"", kBall},
    {"equirectangular", "Camera \"spherical\" \"string mapping\" \"equirectangular\"", kBall},
    {"realistic",
     "Camera \"realistic\" \"string lensfile\" \"lens.dat\" \"float aperturediameter\" 12 \"float "
     "focusdistance\" 5 \"string aperture\" \"pentagon\"",
     kBall},
    // Films
    {"measured sensor",
     "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 12 \"string sensor\" \"canon_eos_5d\"",
     kBall},
    {"spectral film",
     "Film \"spectral\" \"integer xresolution\" 16 \"integer yresolution\" 12 \"integer nbuckets\" 5", kBall},
    {"gbuffer film", "Film \"gbuffer\" \"integer xresolution\" 16 \"integer yresolution\" 12", kBall},
    {"clamped film with a crop",
     "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 12 \"integer pixelbounds\" [ 2 15 1 9 "
     "] "
     "\"float maxcomponentvalue\" 0.7 \"bool savefp16\" false",
     kBall},
    // Samplers and filters
    {"independent", "Sampler \"independent\" \"integer pixelsamples\" 4 PixelFilter \"box\"", kBall},
    {"stratified",
     "Sampler \"stratified\" \"integer xsamples\" 2 \"integer ysamples\" 2 PixelFilter \"triangle\"", kBall},
    {"sobol", "Sampler \"sobol\" \"integer pixelsamples\" 4 PixelFilter \"mitchell\"", kBall},
    {"paddedsobol", "Sampler \"paddedsobol\" \"integer pixelsamples\" 4 PixelFilter \"sinc\"", kBall},
    {"halton", "Sampler \"halton\" \"integer pixelsamples\" 5", kBall},
    {"pmj02bn", "Sampler \"pmj02bn\" \"integer pixelsamples\" 4", kBall},
    // Integrators
    {"path with regularisation", "Integrator \"path\" \"bool regularize\" true", kBall},
    {"mixture", "Integrator \"mixture\"", kBall},
    {"simplepath", "Integrator \"simplepath\"", kBall},
    {"diffuse surfaces at pixel centres",
     "Option \"forcediffuse\" true Option \"disablepixeljitter\" true Option \"disablewavelengthjitter\" "
     "true",
     kBall},
    // Materials
    {"dispersion", "", "Material \"dielectric\" \"spectrum eta\" \"glass-F11\" Shape \"sphere\""},
    {"rough dielectric", "", "Material \"dielectric\" \"float roughness\" 0.3 Shape \"sphere\""},
    {"thindielectric", "", "Material \"thindielectric\" Shape \"sphere\""},
    {"conductor", "",
     "Material \"conductor\" \"float uroughness\" 0.4 \"float vroughness\" 0.1 Shape \"sphere\""},
    {"diffusetransmission", "", "Material \"diffusetransmission\" Shape \"sphere\""},
    {"coateddiffuse", "",
     "Material \"coateddiffuse\" \"float roughness\" 0.2 \"rgb albedo\" [ 0.5 0.3 0.2 ] Shape \"sphere\""},
    {"coatedconductor", "",
     "Material \"coatedconductor\" \"float thickness\" 0.1 \"rgb albedo\" [ 0.2 0.3 0.6 ] Shape \"sphere\""},
    {"measured", "", "Material \"measured\" \"string filename\" \"brdf.bsdf\" Shape \"sphere\""},
    {"mix", "",
     "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"b\" \"string type\" "
     "\"conductor\" "
     "Material \"mix\" \"string materials\" [ \"a\" \"b\" ] Shape \"sphere\""},
    {"relief", "",
     "Texture \"d\" \"float\" \"fbm\" Material \"diffuse\" \"texture displacement\" \"d\" Shape \"sphere\" "
     "Material \"diffuse\" \"string normalmap\" \"image.pfm\" Translate 1 1 0 Shape \"sphere\""},
    {"subsurface", "",
     "Material \"subsurface\" \"string name\" \"Skin1\" \"float scale\" 3 Shape \"sphere\""},
    // Media
    {"homogeneous around the camera",
     "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ 0.1 0.2 0.3 ] \"rgb sigma_a\" "
     "[ 0.01 "
     "0.01 0.02 ] \"float g\" 0.5 MediumInterface \"m\" Camera \"perspective\"",
     kBall},
    {"uniformgrid", "",
     "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 3 \"integer ny\" 2 \"integer nz\" "
     "2 "
     "\"float density\" [ 0 1 4 2 0 0 3 1 0 1 5 0 ] \"point3 p0\" [ -1 -1 -1 ] \"float temperature\" "
     "[ 0 900 3000 0 0 0 2000 0 0 0 4000 0 ] MediumInterface \"m\" \"\" Material \"interface\" Shape "
     "\"sphere\""},
    {"rgbgrid in glass", "",
     "MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" \"integer nx\" 2 \"rgb sigma_s\" [ 9 1 0 0 1 9 ] "
     "\"point3 "
     "p0\" [ -1 -1 -1 ] MediumInterface \"m\" \"\" Material \"dielectric\" Shape \"sphere\""},
    {"cloud", "",
     "Translate -1 -1 -1 Scale 2 2 2 MakeNamedMedium \"m\" \"string type\" \"cloud\" \"rgb sigma_s\" [ 5 5 5 "
     "] "
     "MediumInterface \"m\" \"\" Material \"interface\" Translate 0.5 0.5 0.5 Shape \"sphere\" \"float "
     "radius\" 0.5"},
    {"nanovdb", "",
     "Translate -3 -3.5 -29.8 MakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string filename\" "
     "\"fog.nvdb\" "
     "MediumInterface \"m\" \"\" Material \"interface\" Translate 3 3.5 29.8 Shape \"sphere\""},
    {"openvdb", "",
     "Translate -3 -3.5 -29.8 MakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string filename\" "
     "\"fog.vdb\" "
     "MediumInterface \"m\" \"\" Material \"interface\" Translate 3 3.5 29.8 Shape \"sphere\""},
    // Lights
    {"photometry", "",
     "LightSource \"goniometric\" \"string filename\" \"lamp.ies\" \"float power\" 90 Translate 0 -1 1 Shape "
     "\"sphere\""},
    {"projection", "",
     "Translate 0 0 -4 LightSource \"projection\" \"string filename\" \"image.pfm\" \"float power\" 30 "
     "Translate 0 0 4 Shape \"sphere\""},
    {"portal", "",
     "LightSource \"infinite\" \"string filename\" \"image.pfm\" \"point3 portal\" "
     "[ -3 -1 -3  -3 3 -3  -3 3 3  -3 -1 3 ] Shape \"sphere\""},
    {"image area light", "",
     "AreaLightSource \"diffuse\" \"string filename\" \"image.pfm\" \"bool twosided\" true Shape \"disk\""},
    {"distant and blackbody lights", "",
     "LightSource \"distant\" \"blackbody L\" [ 4000 ] \"float illuminance\" 3 \"point3 from\" [ 1 3 -2 ] "
     "Shape "
     "\"sphere\""},
};
constexpr int kSceneCount = static_cast<int>(std::size(kScenes));

constexpr const char* kHead =
    "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 12\n"
    "Sampler \"zsobol\" \"integer pixelsamples\" 4\nIntegrator \"volpath\" \"integer maxdepth\" 8\n"
    "LookAt 0 1 -5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 50\n";

constexpr const char* kRoom =
    "\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [ 0.4 0.5 0.6 ]\n"
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 40 40 30 ] Translate 2 4 -3 Shape \"sphere\" "
    "\"float radius\" 0.4 AttributeEnd\n"
    "Shape \"bilinearmesh\" \"point3 P\" [ -4 -1.2 -4  4 -1.2 -4  -4 -1.2 4  4 -1.2 4 ]\n";

class KindBits : public EndToEnd {
 protected:
  KindBits() {
    Copy("ply/ascii.ply", "mesh.ply");
    Copy("measured_brdf/isotropic", "brdf.bsdf");
    Copy("nanovdb/two_grids.nvdb", "fog.nvdb");
    Copy("openvdb/two_grids.vdb", "fog.vdb");
    Copy("ies/quadrants", "lamp.ies");
    Write("quad.ply",
          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
          "property float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_indices\n"
          "end_header\n-1 -1 0 0 0\n1 -1 0 1 0\n1 1 0.2 1 1\n-1 1 0 0 1\n4 0 1 2 3\n");
    Write("lens.dat", "30 6 1.6 26\n-60 2 1 26\n0 4 0 20\n-25 2 1.7 20\n-40 30 1 20\n");
    std::string image = "PF\n2 2\n-1.0\n";
    for (int i = 0; i < 12; ++i) image += std::string("\0\0", 2) + static_cast<char>(16 * i) + '\x3f';
    Write("image.pfm", image);
    for (int i = 0; i < kSceneCount; ++i) {
      const KindScene& scene = kScenes[i];
      Write(Numbered("kind", i, "pbrt"), std::string(kHead) + scene.settings + kRoom + "AttributeBegin\n" +
                                             scene.world + "\nAttributeEnd\n");
    }
  }

  static std::string Numbered(const std::string& name, int scene, const std::string& ending) {
    char number[8];
    std::snprintf(number, sizeof number, ".%04d.", scene);
    return name + number + ending;
  }
  void Copy(const std::string& from, const std::string& to) const {
    std::ifstream file(SourceDir() + "/tests/fuzz/corpus/" + from, std::ios::binary);
    Write(to, std::string(std::istreambuf_iterator<char>(file), {}));
  }
  // Renders all scenes as the frames of a sequence: `name`.0000.exr, ...
  void RenderAll(const std::string& name, std::vector<std::string> way) const {
    way.insert(way.begin(), {"render", Path("kind.####.pbrt"), "--frames",
                             "0-" + std::to_string(kSceneCount - 1), "-o", name + ".####.exr"});
    const Outcome outcome = Tessera(way);
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
  }
};

TEST_F(KindBits, AreTheSameForAnyNumberOfWorkersThreadsAndTilesAndInEveryAccelerator) {
  ASSERT_NO_FATAL_FAILURE(RenderAll("oracle", {"--in-process", "--threads", "1"}));
  const std::vector<std::vector<std::string>> ways{{"--in-process", "--threads", "3", "--tile-size", "7"},
                                                   {"--in-process", "--accelerator", "bvh"},
                                                   {"--in-process", "--accelerator", "list"},
                                                   {"--workers", "1", "--threads", "1", "--tile-size", "5"},
                                                   {"--workers", "3", "--threads", "2"}};
  for (const auto& way : ways) {
    ASSERT_NO_FATAL_FAILURE(RenderAll("picture", way));
    for (int i = 0; i < kSceneCount; ++i) {
      EXPECT_TRUE(Bytes(Numbered("picture", i, "exr")) == Bytes(Numbered("oracle", i, "exr")))
          << kScenes[i].name << " " << testing::PrintToString(way);
    }
  }
  // Each scene shows its kind: none is the picture of another.
  for (int i = 1; i < kSceneCount; ++i) {
    EXPECT_FALSE(Bytes(Numbered("oracle", i, "exr")) == Bytes(Numbered("oracle", i - 1, "exr")))
        << kScenes[i].name;
  }
}

// The options of the command line travel with the job.
TEST_F(KindBits, OfOptionsAreTheSameOnAFarm) {
  const std::string scene = Path(Numbered("kind", 0, "pbrt"));
  const std::vector<std::vector<std::string>> choices{
      {"--disable-pixel-jitter"},
      {"--disable-wavelength-jitter"},
      {"--disable-texture-filtering", "--force-diffuse", "--pixelbounds", "3,11,2,9"},
      {"--quick", "--aov", "albedo"},
  };
  for (const auto& choice : choices) {
    const std::string oracle = Oracle(scene, choice);
    EXPECT_FALSE(oracle == Oracle(scene, {})) << testing::PrintToString(choice);
    std::vector<std::string> words{"render", scene, "-o", "picture.exr", "--workers", "2"};
    words.insert(words.end(), choice.begin(), choice.end());
    const Outcome outcome = Tessera(words);
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Bytes("picture.exr") == oracle) << testing::PrintToString(choice);
  }
}

}  // namespace
}  // namespace tessera
