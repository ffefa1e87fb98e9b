#include "coordinator/core/fact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>

#include "coordinator/core/byte_codec.h"
#include "renderer/util/hash.h"

namespace tessera {
namespace {

Fact Submitted() {
  auto spec = std::make_shared<JobSpec>();
  spec->submission = 9;
  spec->name = "a job";
  spec->priority = -7;
  spec->package = Sha256("p");
  spec->required_tags = {"gpu", "linux-6"};
  spec->verify_share = 0.125;
  spec->first = Region{0.25f, 0.5f, 0, 1};
  FrameSpec frame;
  frame.width = 40;
  frame.height = 30;
  frame.crop = {1, 2, 39, 28};
  frame.samples_per_pixel = 100;
  frame.exr_type = ExrType::kFloat;
  frame.SetNoiseThreshold(0.07);
  AddChannel(frame.channels, SamplesChannel(true));
  frame.denoiser = Denoiser::kRegression;
  frame.cryptomatte_levels = 5;
  frame.attributes = {{"a", "b"}, {"c", ""}};
  spec->frames = {{"x.pbrt", "spp=3\n", frame, -1, true}, {"y.pbrt", "", frame, 2}};
  return JobSubmitted{JobId{12}, spec};
}

TEST(Fact, AnOrderSurvivesItsBytesAndWhatIsBeyondItsLimitsIsRefused) {
  JobOrder order{9, "a job", -7, {Sha256("p"), "shot/s.##.pbrt", "spp=3\n", FrameRange{1, 9, 2}, 29.97}};
  const auto read_back = [&] {
    return DecodeFact(EncodeFact(JobOrdered{JobId{12}, std::make_shared<const JobOrder>(order)}));
  };
  for (const auto& frames : {std::optional(FrameRange{1, 9, 2}), std::optional<FrameRange>()}) {
    order.scene.frames = frames;
    const auto fact = read_back();
    ASSERT_TRUE(fact);
    const auto& read = std::get<JobOrdered>(*fact);
    EXPECT_EQ(read.job, JobId{12});
    EXPECT_EQ(read.order->submission, 9u);
    EXPECT_EQ(read.order->name, "a job");
    EXPECT_EQ(read.order->priority, -7);
    EXPECT_EQ(read.order->scene, order.scene);
  }
  const SceneOrder good = order.scene;
  for (const char* path : {"", "../s.pbrt", "/s.pbrt", "a//b"}) {
    order.scene.scene_file = path;
    EXPECT_FALSE(read_back()) << path;
  }
  order.scene = good;
  order.scene.frames = FrameRange{5, 4, 1};
  EXPECT_FALSE(read_back());
  order.scene.frames = FrameRange{0, kFramesPerJobMax, 1};
  EXPECT_FALSE(read_back());
  order.scene = good;
  order.scene.frames_per_second = 0;
  EXPECT_FALSE(read_back());
  order.scene = good;
  order.priority = kPriorityMax + 1;
  EXPECT_FALSE(read_back());
}

TEST(Fact, SurvivesItsBytes) {
  const Fact submitted = *DecodeFact(EncodeFact(Submitted()));
  const auto& read = std::get<JobSubmitted>(submitted);
  EXPECT_EQ(read.job, JobId{12});
  EXPECT_EQ(read.spec->name, "a job");
  EXPECT_EQ(read.spec->priority, -7);
  EXPECT_EQ(read.spec->package, Sha256("p"));
  EXPECT_EQ(read.spec->required_tags, (std::set<std::string>{"gpu", "linux-6"}));
  EXPECT_EQ(read.spec->verify_share, 0.125);
  EXPECT_EQ(read.spec->first, (Region{0.25f, 0.5f, 0, 1}));
  ASSERT_EQ(read.spec->frames.size(), 2u);
  EXPECT_EQ(read.spec->frames[0].number, -1);
  EXPECT_TRUE(read.spec->frames[0].extendable);
  EXPECT_FALSE(read.spec->frames[1].extendable);
  EXPECT_EQ(read.spec->frames[0].options, "spp=3\n");
  EXPECT_EQ(read.spec->frames[1].spec, std::get<JobSubmitted>(Submitted()).spec->frames[1].spec);

  const Fact started = *DecodeFact(EncodeFact(CoordinatorStarted{77, {5, 6}}));
  EXPECT_EQ(std::get<CoordinatorStarted>(started).epoch, 77u);
  EXPECT_EQ(std::get<CoordinatorStarted>(started).farm, (FarmId{5, 6}));
  const Fact finished =
      *DecodeFact(EncodeFact(FrameFinished{JobId{3}, 4, {Sha256("f"), 7}, 1'000'000'000'000}));
  EXPECT_EQ(std::get<FrameFinished>(finished).file, (PictureFile{Sha256("f"), 7}));
  EXPECT_EQ(std::get<FrameFinished>(finished).samples, 1'000'000'000'000u);
  const Fact ended = *DecodeFact(EncodeFact(JobEnded{JobId{3}, JobState::kFailed, "why"}));
  EXPECT_EQ(std::get<JobEnded>(ended).state, JobState::kFailed);
  EXPECT_EQ(std::get<JobEnded>(ended).reason, "why");
  const Fact extended = *DecodeFact(EncodeFact(JobExtended{JobId{3}, 77}));
  EXPECT_EQ(std::get<JobExtended>(extended).samples_per_pixel, 77u);
  const Fact resumed = *DecodeFact(EncodeFact(FrameResumed{JobId{3}, 8}));
  EXPECT_EQ(std::get<FrameResumed>(resumed).frame, 8u);
  const Fact forgotten = *DecodeFact(EncodeFact(JobsForgotten{JobId{1234}}));
  EXPECT_EQ(std::get<JobsForgotten>(forgotten).last, JobId{1234});
  for (const bool paused : {false, true}) {
    const Fact pause = *DecodeFact(EncodeFact(JobPaused{JobId{5}, paused}));
    EXPECT_EQ(std::get<JobPaused>(pause).job, JobId{5});
    EXPECT_EQ(std::get<JobPaused>(pause).paused, paused);
  }
  const Fact changed = *DecodeFact(EncodeFact(JobPriorityChanged{JobId{5}, -9}));
  EXPECT_EQ(std::get<JobPriorityChanged>(changed).priority, -9);
}

TEST(Fact, WhatIsSaidOfWorkersSurvivesItsBytes) {
  const Fact barred = *DecodeFact(EncodeFact(WorkerQuarantined{WorkerId{7}, "w", true, "why"}));
  EXPECT_EQ(std::get<WorkerQuarantined>(barred).worker, WorkerId{7});
  EXPECT_EQ(std::get<WorkerQuarantined>(barred).name, "w");
  EXPECT_TRUE(std::get<WorkerQuarantined>(barred).drained);
  EXPECT_EQ(std::get<WorkerQuarantined>(barred).quarantine, "why");
  const WorkUnit unit{JobId{3}, 1, 2, {4, 4}};
  const Fact decoded = *DecodeFact(EncodeFact(VoteRecorded{unit, WorkerId{7}, "w", Sha256("r"), 99}));
  EXPECT_EQ(std::get<VoteRecorded>(decoded).unit, unit);
  EXPECT_EQ(std::get<VoteRecorded>(decoded).worker, WorkerId{7});
  EXPECT_EQ(std::get<VoteRecorded>(decoded).name, "w");
  EXPECT_EQ(std::get<VoteRecorded>(decoded).result, Sha256("r"));
  EXPECT_EQ(std::get<VoteRecorded>(decoded).machine, 99u);
  const Fact counted = *DecodeFact(EncodeFact(UnitsCounted{JobId{3}, 10, 11, 12}));
  EXPECT_EQ(std::get<UnitsCounted>(counted).job, JobId{3});
  EXPECT_EQ(std::get<UnitsCounted>(counted).verified, 10u);
  EXPECT_EQ(std::get<UnitsCounted>(counted).disputed, 11u);
  EXPECT_EQ(std::get<UnitsCounted>(counted).suspect, 12u);
  EXPECT_FALSE(DecodeFact(EncodeFact(VoteRecorded{{JobId{3}, 1, 2, {3, 4}}, WorkerId{7}, "w", {}})));
}

TEST(Fact, TheOwnerOfAJobSurvivesItsBytes) {
  for (const JobOwner& owner : {JobOwner{MemberId{~uint64_t{0}}, "ad\xc3\xa4"}, JobOwner{{}, "local"}}) {
    const std::string bytes = EncodeFact(JobOwned{JobId{3}, owner});
    const Fact owned = *DecodeFact(bytes);
    EXPECT_EQ(std::get<JobOwned>(owned).job, JobId{3});
    EXPECT_EQ(std::get<JobOwned>(owned).owner, owner);
    for (size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(DecodeFact(bytes.substr(0, size)));
  }
}

TEST(Fact, AVoteOfAnOlderReleaseIsReadWithoutItsMachine) {
  const WorkUnit unit{JobId{3}, 1, 2, {4, 4}};
  std::string bytes = EncodeFact(VoteRecorded{unit, WorkerId{7}, "w", Sha256("r"), 99});
  bytes.resize(bytes.size() - sizeof(uint64_t));
  EXPECT_FALSE(DecodeFact(bytes));
  bytes[0] = 20;
  const auto read = DecodeFact(bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(std::get<VoteRecorded>(*read).unit, unit);
  EXPECT_EQ(std::get<VoteRecorded>(*read).result, Sha256("r"));
  EXPECT_EQ(std::get<VoteRecorded>(*read).machine, 0u);
}

// Its record of version 1 ends before the region, and an older release may read those of version 2.
TEST(Fact, AJobOfAnOlderReleaseIsReadWithoutARegionThatGoesFirst) {
  constexpr size_t kRecord = 4 + 8;  // the bytes before the record: the kind and the job
  constexpr size_t kRegion = 5 * 4;  // and of what version 2 adds, at its end
  std::string bytes = EncodeFact(Submitted());
  EXPECT_EQ(bytes.substr(kRecord, 8), std::string("\2\0\0\0\1\0\0\0", 8));
  bytes.resize(bytes.size() - kRegion);
  bytes[kRecord] = 1;
  const uint64_t length = bytes.size() - kRecord - 16;
  for (size_t i = 0; i < 8; ++i) bytes[kRecord + 8 + i] = static_cast<char>(length >> (8 * i));
  const auto read = DecodeFact(bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(std::get<JobSubmitted>(*read).spec->verify_share, 0.125);
  EXPECT_FALSE(std::get<JobSubmitted>(*read).spec->first);
}

TEST(Fact, ARegionBeyondThePictureIsRefused) {
  for (const Region& bad : {Region{0.5f, 0.5f, 0, 1}, Region{0, 1.5f, 0, 1}, Region{0, 1, -1, 1},
                            Region{0, std::nanf(""), 0, 1}}) {
    JobSpec spec = *std::get<JobSubmitted>(Submitted()).spec;
    spec.first = bad;
    EXPECT_FALSE(DecodeFact(EncodeFact(JobSubmitted{JobId{1}, std::make_shared<const JobSpec>(spec)})));
  }
}

TEST(Fact, BytesThatAreCutOrTooLongAreRefused) {
  const std::string bytes = EncodeFact(Submitted());
  for (size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(DecodeFact(bytes.substr(0, size))) << size;
  EXPECT_FALSE(DecodeFact(bytes + '\0'));
}

TEST(Fact, DamagedBytesNeverHarm) {
  const std::string bytes = EncodeFact(Submitted());
  for (uint64_t seed = 0; seed < 5000; ++seed) {
    std::string damaged = bytes;
    for (uint64_t n = 0; n < 1 + seed % 4; ++n) {
      const uint64_t draw = Hash(seed, n);
      damaged[draw % damaged.size()] = static_cast<char>(draw >> 32);
    }
    const auto fact = DecodeFact(damaged);  // whatever it is, its limits hold
    if (!fact) continue;
    if (const auto* job = std::get_if<JobSubmitted>(&*fact)) {
      for (const FrameRequest& frame : job->spec->frames) EXPECT_TRUE(frame.spec.Check());
    }
  }
}

TEST(Fact, APriorityHasItsLimits) {
  EXPECT_TRUE(DecodeFact(EncodeFact(JobPriorityChanged{JobId{5}, kPriorityMax})));
  EXPECT_FALSE(DecodeFact(EncodeFact(JobPriorityChanged{JobId{5}, kPriorityMax + 1})));
}

TEST(Fact, TimesThatNoClockShowsAndNegativePartsAreRefusedAndNotWritten) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const auto read = DecodeFact(EncodeFact(JobTimed{JobId{3}, 1, 2, {-1, kNaN, HUGE_VAL, 7}}));
  ASSERT_TRUE(read) << "what was measured wrong does not stop the next process";
  EXPECT_EQ(std::get<JobTimed>(*read).times.render_s, 0);
  EXPECT_EQ(std::get<JobTimed>(*read).times.waste_s, 0);
  EXPECT_EQ(std::get<JobTimed>(*read).times.fetch_s, 7);
  EXPECT_FALSE(DecodeFact(EncodeFact(JobTimed{JobId{3}, INT64_MIN, {}, {}})));
  EXPECT_FALSE(DecodeFact(EncodeFact(JobTimed{JobId{3}, 1, INT64_MAX, {}})));
}

TEST(Fact, AJobThatEndedCannotBeRunning) {
  EXPECT_FALSE(DecodeFact(EncodeFact(JobEnded{JobId{3}, JobState::kRunning, ""})));
}

JobSpec OneFrame(Denoiser denoiser, uint32_t cryptomatte_levels) {
  JobSpec spec = *std::get<JobSubmitted>(Submitted()).spec;
  spec.frames.resize(1);
  spec.required_tags.clear();
  spec.frames[0].spec.denoiser = denoiser;
  spec.frames[0].spec.cryptomatte_levels = cryptomatte_levels;
  return spec;
}

std::string Head(uint32_t version, uint32_t readable_by) {
  ByteWriter head;
  head.Add32(version);
  head.Add32(readable_by);
  return head.Take();
}

// The fact that a release wrote whose record of a frame had this version, of which the present one has
// members of 32 bits each.
std::string AsOfVersion(uint32_t version, const JobSpec& spec) {
  std::string bytes = EncodeFact(JobSubmitted{JobId{12}, std::make_shared<const JobSpec>(spec)});
  constexpr uint32_t kPresent = 3;
  const size_t lacking = (kPresent - version) * sizeof(uint32_t);
  // The records of the job, of its frame and of what the frame is are nested. The last is followed by the
  // number of tags, the share of units that are verified and the region that goes first.
  const size_t end = bytes.size() - 2 * sizeof(uint64_t) - 5 * sizeof(uint32_t);
  const size_t frame = bytes.rfind(Head(kPresent, version), end);
  if (frame == std::string::npos) return "not readable by that release";
  const size_t job_size = 12 + 8, request_size = bytes.find(Head(1, 1), job_size + 8) + 8;
  bytes.erase(end - lacking, lacking);
  for (const size_t size : {job_size, request_size, frame + 8}) {
    uint64_t length = 0;
    std::memcpy(&length, &bytes[size], sizeof length);
    length -= lacking;
    std::memcpy(&bytes[size], &length, sizeof length);
  }
  bytes[frame] = static_cast<char>(version);
  return bytes;
}

// Version 1 had no denoiser, version 2 no levels of Cryptomatte.
TEST(Fact, AFrameWithTheDefaultsOfWhatWasAddedIsReadByAndOfOlderReleases) {
  for (const auto& [version, denoiser] :
       {std::pair(1u, Denoiser::kNone), std::pair(2u, Denoiser::kRegression)}) {
    const JobSpec spec = OneFrame(denoiser, kCryptomatteLevelsDefault);
    const auto older = DecodeFact(AsOfVersion(version, spec));
    ASSERT_TRUE(older) << version;
    EXPECT_EQ(std::get<JobSubmitted>(*older).spec->frames[0].spec, spec.frames[0].spec) << version;
  }
}

TEST(Fact, AFrameThatOlderReleasesWouldRenderDifferentlyIsRefusedByThem) {
  const std::tuple<Denoiser, uint32_t, uint32_t> cases[] = {{Denoiser::kNone, kCryptomatteLevelsDefault, 1},
                                                            {Denoiser::kOidn, kCryptomatteLevelsDefault, 2},
                                                            {Denoiser::kNone, 1, 3},
                                                            {Denoiser::kOidn, 8, 3}};
  for (const auto& [denoiser, levels, readable_by] : cases) {
    const auto spec = std::make_shared<const JobSpec>(OneFrame(denoiser, levels));
    const std::string bytes = EncodeFact(JobSubmitted{JobId{12}, spec});
    EXPECT_NE(bytes.find(Head(3, readable_by)), std::string::npos) << levels;
    EXPECT_EQ(std::get<JobSubmitted>(*DecodeFact(bytes)).spec->frames[0].spec, spec->frames[0].spec);
  }
}

TEST(Fact, AFrameWithALevelOfCryptomatteTooFewOrTooManyIsRefused) {
  for (const uint32_t levels : {0u, kCryptomatteLevelsMax + 1, 0xffffffffu}) {
    const auto spec = std::make_shared<const JobSpec>(OneFrame(Denoiser::kNone, levels));
    EXPECT_FALSE(DecodeFact(EncodeFact(JobSubmitted{JobId{12}, spec}))) << levels;
  }
}

// Releases before farms had identities wrote it.
TEST(Fact, AStartWithoutAFarmIsRead) {
  const std::string bytes{"\1\0\0\0\7\0\0\0", 8};
  const auto fact = DecodeFact(bytes);
  ASSERT_TRUE(fact);
  EXPECT_EQ(std::get<CoordinatorStarted>(*fact).epoch, 7u);
  EXPECT_EQ(std::get<CoordinatorStarted>(*fact).farm, FarmId{});
}

}  // namespace
}  // namespace tessera
