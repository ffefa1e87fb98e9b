// Scenes that workers prepare, and the frames that come of it, as messages.
#include <gtest/gtest.h>

#include "proto/wire/convert.h"
#include "proto/work.pb.h"

namespace tessera {
namespace {

FrameSpec SomeFrameSpec() {
  FrameSpec frame;
  frame.width = 40;
  frame.height = 30;
  frame.crop = {0, 0, 40, 30};
  frame.samples_per_pixel = 16;
  return frame;
}

TEST(Convert, APreparationAndItsReportSurvive) {
  WorkerDirective directive;
  directive.farm = {5, 6};
  for (const auto& frames : {std::optional(FrameRange{1, 9, 2}), std::optional<FrameRange>()}) {
    directive.preparation = {Sha256("key"), {Sha256("p"), "s.##.pbrt", "spp=3\n", frames, 29.97}};
    proto::WorkerDirective message;
    Write(directive, message);
    const auto read = ReadWorkerDirective(message);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->preparation, directive.preparation);
    message.mutable_preparation()->set_scene_file("../s.pbrt");
    EXPECT_FALSE(ReadWorkerDirective(message));
    message.mutable_preparation()->set_scene_file("s.pbrt");
    message.mutable_preparation()->set_last(UINT32_MAX);
    EXPECT_FALSE(ReadWorkerDirective(message));
  }
  PreparationReport report{
      Sha256("key"), {{"a.pbrt", "spp=3\n", SomeFrameSpec(), 4, true}}, {"a warning"}, "", {5, 6}};
  proto::PreparationReport message;
  Write(report, message);
  const auto read = ReadPreparationReport(message);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->key, report.key);
  EXPECT_EQ(read->farm, report.farm);
  EXPECT_EQ(read->warnings, report.warnings);
  ASSERT_EQ(read->frames.size(), 1u);
  EXPECT_EQ(read->frames[0].spec, report.frames[0].spec);
  EXPECT_TRUE(read->frames[0].extendable);
  message.set_reason("both");
  EXPECT_FALSE(ReadPreparationReport(message));
  message.clear_frames();
  EXPECT_TRUE(ReadPreparationReport(message));
  message.clear_reason();
  EXPECT_FALSE(ReadPreparationReport(message)) << "neither";
}

}  // namespace
}  // namespace tessera
