// renderer/PBRT.md lists what becomes of every kind and parameter of pbrt-v4: each is tried in a small scene.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>

#include "renderer/scene/scene.h"
#include "renderer/scene/scene_language.h"
#include "renderer/util/file.h"
#include "tests/build_paths.h"
#include "tests/renderer/memory_files.h"
#include "tests/renderer/scene/compatibility_rows.h"

namespace tessera::compatibility {
namespace {

constexpr size_t kFileSizeMax = size_t{1} << 20;

enum class Outcome { kRead, kWarned, kRefused };

std::vector<std::string> Split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const size_t end = std::min(text.find(separator), text.size());
    parts.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

// `float fov=45` as a scene writes it.
std::string Written(const std::string& parameter) {
  const size_t equals = parameter.find('=');
  return " \"" + parameter.substr(0, equals) + "\" [ " + parameter.substr(equals + 1) + " ]";
}

std::string OptionValue(std::string_view name) {
  if (name == "rendercoordsys") return "\"world\"";
  if (name == "msereferenceimage" || name == "msereferenceout") return "\"a\"";
  if (name == "seed" || name == "displacementedgescale") return "2";
  return "true";
}

// A scene with one directive of the kind.
std::string SceneWith(const KindRow& row, const std::string& parameters) {
  const std::string kind = fmt::format("\"{}\"{}", row.kind, parameters);
  const std::map<std::string_view, std::string> before{
      {"camera", "Camera "},         {"film", "Film "},
      {"filter", "PixelFilter "},    {"sampler", "Sampler "},
      {"integrator", "Integrator "}, {"accelerator", "Accelerator "}};
  std::string settings, world;
  const std::string ball = "Shape \"sphere\"\n";
  if (const auto found = before.find(row.family); found != before.end()) settings = found->second + kind;
  if (row.family == "light sampler") settings = "Integrator \"path\" \"string lightsampler\" " + kind;
  if (row.family == "option") settings = "Option " + kind + " " + OptionValue(row.kind);
  if (row.family == "shape") world = "Shape " + kind;
  if (row.family == "material") world = "Material " + kind + " " + ball;
  if (row.family == "float texture")
    world =
        "Texture \"t\" \"float\" " + kind + " Material \"dielectric\" \"texture roughness\" \"t\" " + ball;
  if (row.family == "spectrum texture")
    world =
        "Texture \"t\" \"spectrum\" " + kind + " Material \"diffuse\" \"texture reflectance\" \"t\" " + ball;
  if (row.family == "light") world = "LightSource " + kind;
  if (row.family == "area light") world = "AreaLightSource " + kind + " " + ball;
  if (row.family == "medium")
    world = "MakeNamedMedium \"m\" \"string type\" " + kind +
            " MediumInterface \"m\" \"\" Material \"interface\" " + ball;
  return settings + "\nWorldBegin\n" +
         "Texture \"float\" \"float\" \"constant\" Texture \"spectrum\" \"spectrum\" \"constant\"\n"
         "MakeNamedMaterial \"named\" \"string type\" \"diffuse\" LightSource \"infinite\"\n" +
         world;
}

MemoryFiles Files(const std::string& scene) {
  MemoryFiles files({{"scene.pbrt", scene}});
  files.files["image.pfm"] = "PF\n1 1\n-1.0\n" + std::string("\0\0\x80\x3f\0\0\x80\x3f\0\0\x80\x3f", 12);
  files.files["lens.dat"] = "35 20 1.5 25\n-35 2 1 25\n0 30 0 20\n";
  files.files["mesh.ply"] =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float u\nproperty float v\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n"
      "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
  const std::string corpus = SourceDir() + "/tests/fuzz/corpus/";
  if (const auto brdf = ReadFile(corpus + "measured_brdf/isotropic", kFileSizeMax))
    files.files["brdf.bsdf"] = *brdf;
  if (const auto grid = ReadFile(corpus + "nanovdb/two_grids.nvdb", kFileSizeMax))
    files.files["cloud.nvdb"] = *grid;
  return files;
}

struct Trial {
  Outcome outcome = Outcome::kRead;
  size_t warnings = 0;
};

Trial Try(const std::string& scene, size_t warnings_before) {
  MemoryFiles files = Files(scene);
  const Result<std::unique_ptr<Scene>> loaded = Scene::Load(files, "scene.pbrt", {}, Scene::Depth::kCheck);
  if (!loaded) return {Outcome::kRefused, 0};
  const size_t warnings = (*loaded)->summary().warnings.size();
  return {warnings > warnings_before ? Outcome::kWarned : Outcome::kRead, warnings};
}

std::string BaseOf(const KindRow& row) {
  std::string base;
  for (const std::string& parameter : Split(row.base, ';')) base += Written(parameter);
  return base;
}

std::string NameOf(const std::string& parameter) {
  return fmt::format(" `{}`", parameter.substr(0, parameter.find('=')));
}

// The row of one kind: what is read, what gives a warning, what is refused.
std::string TableRow(const KindRow& row, const KindInfo& info) {
  std::string cells[3];
  const std::string base = BaseOf(row);
  // Without the files that only pbrt can write, a kind is what its table says.
  const Trial alone = Try(SceneWith(row, base), 0);
  for (const std::string& parameter : Split(row.base, ';')) cells[0] += NameOf(parameter);
  const bool is_refused = info.support == Support::kNotSupported;
  for (const std::string& parameter : Split(row.parameters, ';')) {
    Outcome outcome = Outcome::kRefused;
    if (!is_refused) {
      outcome = Try(SceneWith(row, base + Written(parameter)), alone.warnings).outcome;
      // Some parameters exclude those without which the kind is refused, or need a second one.
      if (outcome == Outcome::kRefused)
        outcome = Try(SceneWith(row, Written(parameter)), alone.warnings).outcome;
    }
    cells[static_cast<size_t>(outcome)] += NameOf(parameter);
  }
  if (is_refused) {
    cells[0].clear();
    cells[2] = " all";
  }
  const std::string status = info.support == Support::kSupported ? "read"
                             : info.support == Support::kMapped  ? fmt::format("→ {}", info.instead)
                                                                 : "refused";
  return fmt::format("| {} | `{}` | {} |{} |{} |{} |\n", row.family, row.kind, status, cells[0], cells[1],
                     cells[2]);
}

std::string Table() {
  std::string table =
      "| family | kind | the kind is | parameters read | read with a warning | refused "
      "|\n|---|---|---|---|---|---|\n";
  for (const KindList& list : SceneLanguageKinds()) {
    for (const KindInfo& kind : list.kinds) {
      const KindRow* found = nullptr;
      for (const KindRow& row : KindRows()) {
        if (row.family == list.family && row.kind == kind.name) found = &row;
      }
      EXPECT_NE(found, nullptr) << "compatibility_rows.cpp lacks " << list.family << " " << kind.name;
      if (found != nullptr) table += TableRow(*found, kind);
    }
  }
  return table;
}

TEST(Compatibility, TheTableOfTheDocumentationIsUpToDate) {
  const std::string path = SourceDir() + "/renderer/PBRT.md";
  const Result<std::string> written = ReadFile(path, kFileSizeMax);
  ASSERT_TRUE(written) << written.error().message;
  const std::string table = Table();
  const std::string start = "| family | kind |";
  const size_t from = written->find(start);
  ASSERT_NE(from, std::string::npos);
  const size_t end = std::min(written->find("\n\n", from) + 1, written->size());
  if (std::getenv("TESSERA_UPDATE_DOCUMENTATION") != nullptr) {
    std::ofstream(path) << written->substr(0, from) << table << written->substr(end);
    return;
  }
  EXPECT_EQ(written->substr(from, end - from), table)
      << "Run this test with TESSERA_UPDATE_DOCUMENTATION=1 to write the table again.";
}

TEST(Compatibility, EveryKindOfTheRowsIsInTheRegistry) {
  for (const KindRow& row : KindRows()) {
    bool is_known = false;
    for (const KindList& list : SceneLanguageKinds()) {
      for (const KindInfo& kind : list.kinds) is_known |= list.family == row.family && kind.name == row.kind;
    }
    EXPECT_TRUE(is_known) << row.family << " " << row.kind;
  }
}

// Hides no mistake of the rows: what the registry calls supported loads in its smallest form.
TEST(Compatibility, EverySupportedKindLoadsWithTheParametersThatItNeeds) {
  for (const KindList& list : SceneLanguageKinds()) {
    for (const KindInfo& kind : list.kinds) {
      if (kind.support == Support::kNotSupported) continue;
      for (const KindRow& row : KindRows()) {
        if (row.family != list.family || row.kind != kind.name) continue;
        MemoryFiles files = Files(SceneWith(row, BaseOf(row)));
        const Result<std::unique_ptr<Scene>> loaded =
            Scene::Load(files, "scene.pbrt", {}, Scene::Depth::kCheck);
        EXPECT_TRUE(loaded) << row.family << " " << row.kind << ": " << loaded.error().message;
      }
    }
  }
}

}  // namespace
}  // namespace tessera::compatibility
