#include "renderer/integrator/integrator_kinds.h"

#include <gmock/gmock.h>

namespace tessera {
namespace {

TEST(IntegratorKinds, MappedIntegratorHasTheTraitsOfWhatRendersInstead) {
  for (const Kind<IntegratorTraits>& kind : Integrators().kinds()) {
    if (kind.support != Support::kMapped) continue;
    const Kind<IntegratorTraits>* instead = Integrators().Find(kind.instead);
    ASSERT_NE(instead, nullptr) << kind.name;
    EXPECT_EQ(instead->support, Support::kSupported) << kind.name;
    EXPECT_EQ(instead->reader.kind, kind.reader.kind) << kind.name;
    EXPECT_EQ(instead->reader.follows_media, kind.reader.follows_media) << kind.name;
    EXPECT_EQ(instead->reader.has_shadow_rays, kind.reader.has_shadow_rays) << kind.name;
  }
}

TEST(IntegratorKinds, MisspelledIntegratorIsAnsweredWithTheNearestName) {
  EXPECT_EQ(Integrators().Find("volpaht"), nullptr);
  EXPECT_THAT(Integrators().Refusal("volpaht"), testing::HasSubstr("\"volpath\""));
}

}  // namespace
}  // namespace tessera
