#include "renderer/scene/scene_language.h"

#include <gmock/gmock.h>

#include <set>

namespace tessera {
namespace {

TEST(SceneLanguageKinds, NamesEveryFamilyAndEveryKindOnce) {
  std::set<std::string_view> families;
  for (const KindList& list : SceneLanguageKinds()) {
    EXPECT_TRUE(families.insert(list.family).second) << list.family << " is listed twice";
    std::set<std::string_view> names;
    for (const KindInfo& kind : list.kinds) {
      EXPECT_TRUE(names.insert(kind.name).second) << list.family << " " << kind.name << " is listed twice";
      EXPECT_EQ(kind.support == Support::kMapped, !kind.instead.empty())
          << list.family << " " << kind.name << ": exactly the mapped kinds name what is done instead";
    }
    EXPECT_FALSE(names.empty()) << list.family;
  }
  EXPECT_THAT(families, testing::IsSupersetOf({"film", "integrator", "accelerator", "option"}));
}

}  // namespace
}  // namespace tessera
