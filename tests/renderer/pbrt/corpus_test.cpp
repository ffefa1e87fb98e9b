// Scenes that other people wrote, beside what the real pbrt-v4 says of them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>

#include "renderer/pbrt/parser.h"
#include "tests/build_paths.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

fs::path SharedFolder() {
  if (const char* folder = std::getenv("TESSERA_SHARED")) return folder;
  return fs::path(SourceDir()).parent_path() / "shared";
}

Result<SceneDescription> ParseFile(const fs::path& path) {
  DiskFileSource files(path.parent_path().string());
  return ParseScene(files, path.filename().string());
}

// "rc=0 scenes/x.pbrt message" lines: path and whether pbrt-v4 rendered it.
std::vector<std::pair<std::string, bool>> ReadResults(const fs::path& path) {
  std::vector<std::pair<std::string, bool>> results;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string code, scene;
    words >> code >> scene;
    results.push_back({scene, code == "rc=0"});
  }
  return results;
}

TEST(Corpus, EverySceneThatPbrtRendersParses) {
  const fs::path folder = SharedFolder() / "corpora/pbrt/houdini-pbrt-v4-tests";
  if (!fs::exists(folder))
    GTEST_SKIP() << folder << " is absent: set TESSERA_SHARED to the folder of the corpora";
  int accepted = 0;
  const auto results = ReadResults(folder / "PBRT-V4-RESULTS.txt");
  EXPECT_GT(results.size(), 100u);
  for (const auto& [name, pbrt_renders] : results) {
    const Result<SceneDescription> scene = ParseFile(folder / name);
    accepted += scene.has_value();
    EXPECT_TRUE(scene.has_value() || !pbrt_renders) << (scene ? "" : scene.error().message);
  }
  EXPECT_EQ(ParseFile(folder / "scenes/TestArchive/test_singlegeo.pbrt").error().message,
            "test_singlegeo.pbrt:1:1: AttributeBegin is not allowed here, expected WorldBegin before it");
  EXPECT_EQ(ParseFile(folder / "scenes/TestGeoLight/test_geolight_no_geo.pbrt").error().message,
            "test_geolight_no_geo.pbrt:17:5: AttributeBegin without AttributeEnd before the end of the file");
  std::cout << accepted << " of " << results.size() << " scenes parse\n";
  RecordProperty("parsed", accepted);
}

// Files that are no whole scenes are told by their first error.
bool IsFragment(const Error& error) {
  return error.message.find("expected WorldBegin before it") != std::string::npos ||
         error.message.find("the file ends without WorldBegin") != std::string::npos;
}

TEST(Corpus, EveryOtherSceneParsesOrIsAFragment) {
  const fs::path shared = SharedFolder();
  if (!fs::exists(shared / "scenes")) GTEST_SKIP() << shared << " is absent: set TESSERA_SHARED to it";
  int accepted = 0, fragments = 0;
  for (const char* top : {"scenes", "corpora/pbrt"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(shared / top)) {
      if (entry.path().extension() != ".pbrt") continue;
      if (entry.path().string().find("houdini") != std::string::npos) continue;  // the test above has them
      const Result<SceneDescription> scene = ParseFile(entry.path());
      accepted += scene.has_value();
      const bool is_fragment = !scene && IsFragment(scene.error());
      fragments += is_fragment;
      EXPECT_TRUE(scene || is_fragment) << entry.path() << ": " << (scene ? "" : scene.error().message);
    }
  }
  std::cout << accepted << " scenes parse, " << fragments << " files are fragments of scenes\n";
  EXPECT_GT(accepted, 20);
}

}  // namespace
}  // namespace tessera
