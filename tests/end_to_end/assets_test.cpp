// The files that a submitted scene sends to a farm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using Assets = EndToEnd;

// A disk with a texture of its own.
std::string Disk(int number) {
  const std::string n = std::to_string(number);
  return "AttributeBegin\nTranslate " + n + " 0 4\nTexture \"t" + n +
         "\" \"spectrum\" \"imagemap\" \"string filename\" \"t" + n +
         ".pfm\"\nMaterial \"diffuse\" \"texture reflectance\" \"t" + n +
         "\"\nShape \"disk\" \"float radius\" 1\nAttributeEnd\n";
}

// 512 x 512 pixels of three floats, as a PFM: 3 MB, different for each seed.
std::string Picture(int seed) {
  std::string bytes = "PF\n512 512\n-1.0\n";
  const float value = static_cast<float>(seed % 100) / 100;
  for (int i = 0; i < 512 * 512 * 3; ++i) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  return bytes;
}

TEST_F(Assets, OnlyMissingFilesAreUploaded) {
  StartCoordinator();
  std::string scene =
      "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\nCamera \"perspective\"\n"
      "Sampler \"independent\" \"integer pixelsamples\" 1\nWorldBegin\nLightSource \"point\"\n";
  for (int i = 0; i < 4; ++i) {
    scene += Disk(i);
    Write("t" + std::to_string(i) + ".pfm", Picture(i));
  }
  const std::string path = Write("scene.pbrt", scene);
  const Outcome first = Ask({"submit", path});
  EXPECT_EQ(first.code, 0) << first.errors;
  EXPECT_THAT(first.errors, HasSubstr("uploaded 5 of 5 files, 12."));
  const Outcome second = Ask({"submit", path});
  EXPECT_THAT(second.errors, HasSubstr("uploaded 0 of 5 files, 0 B"));
  Write("t2.pfm", Picture(50));
  const Outcome third = Ask({"submit", path});
  EXPECT_THAT(third.errors, HasSubstr("uploaded 1 of 5 files, 3.15 MB"));
}

TEST_F(Assets, TheStatusOfAJobShowsHowTheTimeWasSpent) {
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit(BoxScene(), {});
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  const Outcome status = Ask({"status", job});
  EXPECT_THAT(status.output, HasSubstr("of render slots:"));
  EXPECT_THAT(status.output, HasSubstr("  rendering\n"));
  EXPECT_THAT(status.output, HasSubstr("coordinator, at the same time: merging"));
  EXPECT_GT(Figure(job, "render_s"), 0);
  EXPECT_GE(Figure(job, "writing_s"), 0);
}

}  // namespace
}  // namespace tessera
