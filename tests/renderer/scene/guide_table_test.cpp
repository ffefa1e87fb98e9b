// The guide's table of kinds is the one that the scene language's own lists give.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "renderer/description/file_source.h"
#include "renderer/scene/scene_language.h"
#include "renderer/util/file.h"
#include "tests/build_paths.h"

namespace tessera {
namespace {

constexpr size_t kPageSizeMax = size_t{1} << 20;

// The kinds of this support, as a cell of the table: `bvh`, `kdtree` (→ `bvh`).
std::string Cell(const KindList& list, Support support) {
  std::string cell;
  for (const KindInfo& kind : list.kinds) {
    if (kind.support != support) continue;
    cell += fmt::format(" `{}`", kind.name);
    if (support == Support::kMapped) cell += fmt::format(" (→ {})", kind.instead);
  }
  return cell;
}

std::string ExpectedTable() {
  std::string table =
      "| family | supported | replaced, with a warning | not supported yet |\n"
      "|---|---|---|---|\n";
  for (const KindList& list : SceneLanguageKinds()) {
    table += fmt::format("| {} |{} |{} |{} |\n", list.family, Cell(list, Support::kSupported),
                         Cell(list, Support::kMapped), Cell(list, Support::kNotSupported));
  }
  return table;
}

TEST(Guide, ItsTableListsEveryKindWithItsSupport) {
  const Result<std::string> page = ReadFile(SourceDir() + "/client/guide/scenes.md", kPageSizeMax);
  ASSERT_TRUE(page) << page.error().message;
  const std::string expected = ExpectedTable();
  EXPECT_NE(page->find("\n" + expected + "\n"), std::string::npos)
      << "Replace the table of client/guide/scenes.md with this one:\n\n"
      << expected;
}

}  // namespace
}  // namespace tessera
