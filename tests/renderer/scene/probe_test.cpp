#include "renderer/scene/probe.h"
#include "tests/build_paths.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace tessera {
namespace {

// The digest that the programs of this release expect, as proto/probe.h has it: the renderer does not link
// that.
std::string ExpectedDigest() {
  std::ifstream file(SourceDir() + "/proto/probe.h");
  std::ostringstream text;
  text << file.rdbuf();
  const size_t begin = text.str().find("kProbeDigest = \"") + 16;
  return text.str().substr(begin, 64);
}

TEST(Probe, HasTheDigestOfThisRelease) {
  const auto digest = RenderProbe();
  ASSERT_TRUE(digest) << digest.error().message;
  EXPECT_EQ(digest->Hex(), ExpectedDigest())
      << "pictures have changed by at least a bit: if that is meant, put " << digest->Hex()
      << " into proto/probe.h";
}

TEST(Probe, IsTheSameAgainOnAnyNumberOfThreads) {
  const Digest alone = *RenderProbe();
  EXPECT_EQ(*RenderProbe(), alone);
  for (const int threads : {2, 3, 16}) EXPECT_EQ(*RenderProbe(threads), alone) << threads;
}

}  // namespace
}  // namespace tessera
