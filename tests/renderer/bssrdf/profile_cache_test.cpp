#include "renderer/bssrdf/profile_cache.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

constexpr uint64_t kBytes = 1 << 20;

TEST(ProfileCache, ScenesThatShareACacheShareProfilesOfTheSameParameters) {
  const auto shared = std::make_shared<SharedCache>(kBytes);
  ProfileCache first(shared), second(shared);
  const auto profile = first.Get(0.25f, 1.5f);
  EXPECT_EQ(first.Get(0.25f, 1.5f), profile);
  EXPECT_EQ(second.Get(0.25f, 1.5f), profile);
  EXPECT_NE(second.Get(0.5f, 1.5f), profile);
  EXPECT_NE(second.Get(0.25f, 1.25f), profile);
  EXPECT_GE(shared->bytes(), 3 * sizeof(DiffusionProfile));
}

TEST(ProfileCache, ScenesWithoutASharedCacheComputeTheSameProfile) {
  ProfileCache first(nullptr), second(nullptr);
  const auto a = first.Get(0.25f, 1.5f), b = second.Get(0.25f, 1.5f);
  EXPECT_EQ(first.Get(0.25f, 1.5f), a);
  EXPECT_NE(a, b);
  for (const float radius : {0.0f, 0.1f, 1.0f, 7.0f})
    EXPECT_EQ(a->Evaluate(a->PlaceOf(0.8f), radius), b->Evaluate(b->PlaceOf(0.8f), radius));
}

}  // namespace
}  // namespace tessera
