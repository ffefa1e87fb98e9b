// Gives the files of tests/fuzz/corpus to their targets: seeds, which are valid, and found-WHAT, on which a
// target once failed. Fuzzing itself needs clang (tests/fuzz/run). This test does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <string>
#include <vector>

#include "tests/build_paths.h"
#include "tests/fuzz/targets.h"

namespace tessera {

void PrintTo(const FuzzTarget& target, std::ostream* out) {
  *out << target.name;
}

namespace {

namespace fs = std::filesystem;

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

fs::path Corpus() {
  return fs::path(SourceDir()) / "tests/fuzz/corpus";
}

class FuzzCorpus : public testing::TestWithParam<FuzzTarget> {
 protected:
  static std::vector<fs::path> Files() {
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(Corpus() / GetParam().name))
      paths.push_back(entry.path());
    std::ranges::sort(paths);
    return paths;
  }
};

TEST_P(FuzzCorpus, SeedsAreValid) {
  size_t seeds = 0;
  for (const fs::path& path : Files()) {
    if (path.filename().string().starts_with("found-")) continue;
    ++seeds;
    EXPECT_TRUE(GetParam().read(BytesOf(path))) << path;
  }
  EXPECT_GT(seeds, 0u);
}

TEST_P(FuzzCorpus, DamagedFilesAreReadOrRefused) {
  for (const fs::path& path : Files()) {
    SCOPED_TRACE(path);
    const std::string bytes = BytesOf(path);
    GetParam().read(bytes);
    constexpr size_t kParts = 16;
    for (size_t part = 0; part < kParts; ++part) {
      GetParam().read(std::string_view(bytes).substr(0, bytes.size() * part / kParts));
      std::string flipped = bytes;
      if (!bytes.empty()) flipped[(bytes.size() - 1) * part / kParts] ^= static_cast<char>(1 << part % 8);
      GetParam().read(flipped);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, FuzzCorpus, testing::ValuesIn(FuzzTargets().begin(), FuzzTargets().end()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(FuzzCorpusFolders, AllBelongToTargets) {
  for (const auto& entry : fs::directory_iterator(Corpus())) {
    EXPECT_TRUE(std::ranges::any_of(FuzzTargets(), [&](const FuzzTarget& target) {
      return entry.path().filename() == target.name;
    })) << entry.path();
  }
}

}  // namespace
}  // namespace tessera
