// Everything that comes in through messages: good values survive the way there and back, bad ones are
// refused.
#include "proto/wire/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "proto/jobs.pb.h"
#include "proto/work.pb.h"

#include "tests/proto/wire/frame_examples.h"

namespace tessera {
namespace {

using testing::HasSubstr;

std::vector<bool> SomePixels() {
  return {true, false, false, true, true, false, false, false};
}

JobSpec GoodJob() {
  return {5,
          "a job",
          -3,
          Sha256("package"),
          {{"scene.pbrt", "spp=4\n", GoodFrame(), 1}, {"b.pbrt", "", GoodFrame(), 2}},
          {"gpu", "linux-6"},
          0.05,
          Region{0.25f, 0.5f, 0, 1}};
}

WorkUnit GoodUnit() {
  return {JobId{3}, 1, 9, {4, 4}, Sha256("s")};
}

WorkerState GoodState() {
  WorkerState state;
  state.memory_bytes = 9'000;
  state.worker = WorkerId{77};
  state.sequence = 5;
  state.name = "machine";
  state.slots = 8;
  state.scenes = {{Sha256("s"), true}, {Sha256("t"), false}};
  state.farm = {~uint64_t{0} - 3, 0x0102030405060708};
  state.leases = {{LeaseId{1, 99}, GoodUnit(), LeaseStage::kRunning, std::chrono::milliseconds(1500)}};
  state.returned_leases = {LeaseId{2, 98}};
  state.tags = {"gpu", "big.memory"};
  state.wait = std::chrono::milliseconds(2000);
  return state;
}

TEST(Convert, FrameSpecSurvives) {
  proto::FrameSpec message;
  Write(GoodFrame(), message);
  const auto read = ReadFrameSpec(message);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, GoodFrame());
}

TEST(Convert, JobSpecSurvives) {
  proto::JobSpec message;
  Write(GoodJob(), message);
  const auto read = ReadJobSpec(message);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->submission, 5u);
  EXPECT_EQ(read->name, "a job");
  EXPECT_EQ(read->priority, -3);
  EXPECT_EQ(read->package, Sha256("package"));
  ASSERT_EQ(read->frames.size(), 2u);
  EXPECT_EQ(read->frames[0].options, "spp=4\n");
  EXPECT_EQ(read->frames[1].scene_file, "b.pbrt");
  EXPECT_EQ(read->frames[1].number, 2);
  EXPECT_EQ(read->required_tags, GoodJob().required_tags);
  EXPECT_EQ(read->verify_share, 0.05);
  EXPECT_EQ(read->first, GoodJob().first);
}

TEST(Convert, WorkerStateSurvives) {
  proto::WorkerState message;
  Write(GoodState(), message);
  const auto read = ReadWorkerState(message);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->worker, WorkerId{77});
  EXPECT_EQ(read->farm, GoodState().farm);
  EXPECT_EQ(read->slots, 8);
  ASSERT_EQ(read->scenes.size(), 2u);
  EXPECT_TRUE(read->scenes[0].ready);
  EXPECT_FALSE(read->scenes[1].ready);
  ASSERT_EQ(read->leases.size(), 1u);
  EXPECT_EQ(read->leases[0].id, (LeaseId{1, 99}));
  EXPECT_EQ(read->leases[0].unit, GoodUnit());
  EXPECT_EQ(read->leases[0].stage, LeaseStage::kRunning);
  EXPECT_EQ(read->leases[0].stage_duration.count(), 1500);
  EXPECT_EQ(read->returned_leases, (std::vector{LeaseId{2, 98}}));
  EXPECT_EQ(read->tags, GoodState().tags);
  EXPECT_EQ(read->wait.count(), 2000);
  EXPECT_EQ(read->memory_bytes, 9'000u);
}

TEST(Convert, DirectiveSurvives) {
  WorkerDirective directive;
  const Digest package = Sha256("p");
  directive.scenes = {{SceneKey(package, "a.pbrt", "o", GoodFrame()), package, "a.pbrt", "o", GoodFrame()}};
  directive.farm = {5, 6};
  directive.leases = {{LeaseId{4, 97},
                       GoodUnit(),
                       {0, 0, 4, 2},
                       PixelMask::Of(SomePixels()),
                       std::chrono::milliseconds(9000)}};
  directive.drop = {LeaseId{8, 97}, LeaseId{9, 97}};
  directive.notice = "quarantined";
  proto::WorkerDirective message;
  Write(directive, message);
  const auto read = ReadWorkerDirective(message);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->farm, (FarmId{5, 6}));
  ASSERT_EQ(read->leases.size(), 1u);
  EXPECT_EQ(read->leases[0].id, (LeaseId{4, 97}));
  EXPECT_EQ(read->leases[0].unit, GoodUnit());
  EXPECT_EQ(read->leases[0].bounds, (PixelBounds{0, 0, 4, 2}));
  EXPECT_EQ(read->leases[0].pixels, PixelMask::Of(SomePixels()));
  EXPECT_EQ(read->leases[0].duration.count(), 9000);
  EXPECT_EQ(read->drop, directive.drop);
  EXPECT_EQ(read->notice, "quarantined");
  ASSERT_EQ(read->scenes.size(), 1u);
  EXPECT_EQ(read->scenes[0].key, directive.scenes[0].key);
}

TEST(Convert, StatusSurvives) {
  JobStatus status;
  status.job = JobId{3};
  status.name = "name";
  status.priority = 4;
  status.state = JobState::kPaused;
  status.reason = "no room";
  status.samples_total = 20;
  status.elapsed = std::chrono::milliseconds(30);
  status.left = std::chrono::milliseconds(-1);
  status.frames_total = 5;
  status.paused_by_user = true;
  status.verify_share = 0.5;
  status.units_verified = 6;
  status.units_disputed = 7;
  status.units_suspect = 8;
  status.owner = {MemberId{9}, "ada"};
  proto::JobStatus message;
  Write(status, message);
  EXPECT_FALSE(ReadJobStatus(message)->noise) << "not known";
  status.noise = 0.25;
  Write(status, message);
  const auto read = ReadJobStatus(message);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->state, JobState::kPaused);
  EXPECT_EQ(read->reason, "no room");
  EXPECT_EQ(read->samples_total, 20u);
  EXPECT_EQ(read->elapsed.count(), 30);
  EXPECT_EQ(read->left.count(), -1);
  EXPECT_TRUE(read->paused_by_user);
  EXPECT_EQ(read->verify_share, 0.5);
  EXPECT_EQ(read->units_verified, 6u);
  EXPECT_EQ(read->units_disputed, 7u);
  EXPECT_EQ(read->units_suspect, 8u);
  EXPECT_EQ(read->frames_total, 5u);
  EXPECT_EQ(read->owner, status.owner);
  EXPECT_EQ(read->noise, 0.25);
}

TEST(Convert, WhatAWorkerHoldsSurvives) {
  WorkerStatus status;
  status.worker = WorkerId{1};
  status.memory_bytes = 5'000'000'000;
  status.scenes = {JobId{3}, JobId{4}};
  status.last_failure = "no room";
  proto::WorkerStatus message;
  Write(status, message);
  const auto read = ReadWorkerStatus(message);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->memory_bytes, 5'000'000'000u);
  EXPECT_EQ(read->scenes, status.scenes);
  EXPECT_EQ(read->last_failure, "no room");
  for (size_t i = 0; i < kScenesShownMax; ++i) message.add_scenes(1);
  EXPECT_FALSE(ReadWorkerStatus(message));
}

TEST(Convert, AJobLogSurvivesAndHasALimit) {
  const JobLogPage page{
      {{5, 1'700'000'000'000, MessageLevel::kWarning, "worker blade-1 is gone"}}, true, false};
  proto::JobLogAnswer message;
  Write(page, message);
  const auto read = ReadJobLog(message);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->entries, page.entries);
  EXPECT_TRUE(read->has_more);
  EXPECT_FALSE(read->has_ended);
  message.mutable_entries(0)->set_level(static_cast<proto::MessageLevel>(3));
  EXPECT_FALSE(ReadJobLog(message));
  message.mutable_entries(0)->set_level(proto::MESSAGE_LEVEL_ERROR);
  for (size_t i = 0; i < kLogEntriesPerCallMax; ++i) message.add_entries();
  EXPECT_FALSE(ReadJobLog(message));
}

TEST(Convert, RefusesHostileUnits) {
  const std::pair<const char*, std::function<void(proto::WorkUnit&)>> table[] = {
      {"no job", [](auto& m) { m.set_job(0); }},
      {"no range", [](auto& m) { m.clear_range(); }},
      {"empty range", [](auto& m) { m.mutable_range()->set_size(0); }},
      {"odd size", [](auto& m) { m.mutable_range()->set_size(3); }},
      {"not aligned", [](auto& m) { m.mutable_range()->set_begin(2); }},
      {"range that wraps", [](auto& m) { m.mutable_range()->set_begin(0xfffffffc); }},
      {"size that wraps", [](auto& m) { m.mutable_range()->set_size(0x80000000); }},
      {"frame", [](auto& m) { m.set_frame(0xffffffff); }},
  };
  for (const auto& [what, spoil] : table) {
    proto::WorkUnit message;
    Write(GoodUnit(), message);
    spoil(message);
    EXPECT_FALSE(ReadWorkUnit(message)) << what;
  }
}

TEST(Convert, RefusesHostileLeases) {
  const std::pair<const char*, std::function<void(proto::Lease&)>> table[] = {
      {"no unit", [](auto& m) { m.clear_unit(); }},
      {"no bounds", [](auto& m) { m.clear_bounds(); }},
      {"large bounds", [](auto& m) { m.mutable_bounds()->set_x1(kTileSizeMax + 1); }},
      {"short mask", [](auto& m) { m.mutable_bounds()->set_x1(5); }},
      {"long mask", [](auto& m) { m.set_pixels(std::string(2, 'a')); }},
      {"mask of nothing", [](auto& m) { m.set_pixels(std::string(1, '\0')); }},
      {"scene", [](auto& m) { m.mutable_unit()->set_scene("x"); }},
  };
  for (const auto& [what, spoil] : table) {
    proto::Lease message;
    Write(Lease{LeaseId{4}, GoodUnit(), {0, 0, 4, 2}, PixelMask::Of(SomePixels()), {}}, message);
    ASSERT_TRUE(ReadLease(message));
    spoil(message);
    EXPECT_FALSE(ReadLease(message)) << what;
  }
}

TEST(Convert, RefusesHostileWorkers) {
  const std::pair<const char*, std::function<void(proto::WorkerState&)>> table[] = {
      {"worker", [](auto& m) { m.set_worker(0); }},
      {"slots", [](auto& m) { m.set_slots(0); }},
      {"slots", [](auto& m) { m.set_slots(4'000'000'000); }},
      {"build_digest", [](auto& m) { m.set_build_digest(std::string(1000, 'a')); }},
      {"scene", [](auto& m) { m.mutable_scenes(0)->set_scene("short"); }},
      {"stage", [](auto& m) { m.mutable_leases(0)->set_stage(static_cast<proto::HeldLease::Stage>(7)); }},
      {"range", [](auto& m) { m.mutable_leases(0)->mutable_unit()->clear_range(); }},
      {"returned_leases",
       [](auto& m) {
         for (int i = 0; i < kLeasesPerWorkerMax; ++i) m.add_returned_leases();
       }},
      {"scenes",
       [](auto& m) {
         for (int i = 0; i < kScenesPerWorkerMax; ++i) *m.add_scenes() = m.scenes(0);
       }},
      {"tags", [](auto& m) { m.add_tags("two words"); }},
      {"tags", [](auto& m) { m.add_tags(""); }},
      {"tags", [](auto& m) { m.add_tags(std::string(kTagBytesMax + 1, 'a')); }},
      {"tags",
       [](auto& m) {
         for (size_t i = 0; i < kTagsMax; ++i) m.add_tags("t" + std::to_string(i));
       }},
  };
  for (const auto& [field, spoil] : table) {
    proto::WorkerState message;
    Write(GoodState(), message);
    spoil(message);
    const auto read = ReadWorkerState(message);
    ASSERT_FALSE(read) << field;
    EXPECT_THAT(read.error().message, HasSubstr(field));
  }
}

TEST(Convert, AWorkerCannotWaitForEver) {
  proto::WorkerState message;
  Write(GoodState(), message);
  message.set_wait_ms(4'000'000'000);
  EXPECT_EQ(ReadWorkerState(message)->wait, kSynchronizeWaitMax);
}

TEST(Convert, RefusesHostileJobs) {
  const std::pair<const char*, std::function<void(proto::JobSpec&)>> table[] = {
      {"submission", [](auto& m) { m.set_submission(0); }},
      {"priority", [](auto& m) { m.set_priority(kPriorityMax + 1); }},
      {"package", [](auto& m) { m.set_package(""); }},
      {"required_tags", [](auto& m) { m.add_required_tags("g\xffu"); }},
      {"required_tags",
       [](auto& m) {
         for (size_t i = 0; i < kTagsMax; ++i) m.add_required_tags("t" + std::to_string(i));
       }},
      {"first", [](auto& m) { m.mutable_first()->set_x0(0.5f); }},
      {"first", [](auto& m) { m.mutable_first()->set_y1(1.01f); }},
      {"first", [](auto& m) { m.mutable_first()->set_x0(std::nanf("")); }},
      {"verify_share", [](auto& m) { m.set_verify_share(1.01); }},
      {"verify_share", [](auto& m) { m.set_verify_share(-0.01); }},
      {"verify_share", [](auto& m) { m.set_verify_share(std::nan("")); }},
      {"frames", [](auto& m) { m.clear_frames(); }},
      {"scene_file", [](auto& m) { m.mutable_frames(0)->set_scene_file("../../etc/passwd"); }},
      {"options", [](auto& m) { m.mutable_frames(0)->set_options(std::string(kOptionsBytesMax + 1, 'x')); }},
      {"crop", [](auto& m) { m.mutable_frames(1)->mutable_spec()->set_width(5); }},
  };
  for (const auto& [field, spoil] : table) {
    proto::JobSpec message;
    Write(GoodJob(), message);
    spoil(message);
    const auto read = ReadJobSpec(message);
    ASSERT_FALSE(read) << field;
    EXPECT_EQ(read.error().kind, ErrorKind::kBadInput);
  }
}

TEST(Convert, ASceneOrderMustHaveItsOwnKey) {
  const Digest package = Sha256("p");
  SceneRequest order{
      SceneKey(package, "a.pbrt", "o", GoodFrame()), package, "a.pbrt", "o", GoodFrame(), true};
  proto::SceneRequest message;
  Write(order, message);
  const auto read = ReadSceneOrder(message);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->needs_all);
  message.set_options("other");
  EXPECT_FALSE(ReadSceneOrder(message));
  message.set_options("o");
  ASSERT_TRUE(ReadSceneOrder(message));
  message.mutable_frame()->set_samples_per_pixel(GoodFrame().samples_per_pixel + 1);
  EXPECT_FALSE(ReadSceneOrder(message)) << "the frame is a part of it";
}

TEST(Convert, AUnitWithoutItsSceneIsRefused) {
  proto::WorkUnit message;
  Write(GoodUnit(), message);
  message.clear_scene();
  EXPECT_FALSE(ReadWorkUnit(message));
}

TEST(Convert, AFarmIsSixteenBytesOrNone) {
  EXPECT_EQ(*ReadFarmId(""), FarmId{});
  EXPECT_EQ(*ReadFarmId(WriteFarmId({1, 2})), (FarmId{1, 2}));
  EXPECT_FALSE(ReadFarmId(std::string(15, 'x')));
  EXPECT_FALSE(ReadFarmId(std::string(17, 'x')));
}

// Its other fields may have changed their meaning, and admission refuses it by its name.
TEST(Convert, OfAWorkerWithAnotherProtocolOnlyItsNameIsRead) {
  proto::WorkerState message;
  Write(GoodState(), message);
  message.set_protocol(kProtocolVersion - 1);
  message.mutable_leases(0)->mutable_unit()->clear_scene();
  const auto read = ReadWorkerState(message);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->protocol, kProtocolVersion - 1);
  EXPECT_EQ(read->name, "machine");
  EXPECT_TRUE(read->leases.empty());
}

TEST(Convert, TagsAreSetsOfWords) {
  proto::WorkerState message;
  Write(GoodState(), message);
  message.add_tags("gpu");  // once more
  EXPECT_EQ(ReadWorkerState(message)->tags, GoodState().tags);
}

TEST(Convert, PrioritiesHaveTheirLimits) {
  EXPECT_EQ(*ReadPriority(-kPriorityMax), -kPriorityMax);
  EXPECT_FALSE(ReadPriority(kPriorityMax + 1));
  EXPECT_FALSE(ReadPriority(-kPriorityMax - 1));
}

TEST(Convert, FrameStatusesComeBackAsTheyWere) {
  const std::vector<FrameStatus> frames{{1, Sha256("a")}, {3, std::nullopt}};
  proto::FramesAnswer message;
  Write(frames, message);
  const auto read = ReadFrameStatuses(message);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->size(), 2u);
  EXPECT_EQ((*read)[0].number, 1);
  EXPECT_EQ((*read)[0].file, Sha256("a"));
  EXPECT_EQ((*read)[1].number, 3);
  EXPECT_FALSE((*read)[1].file);
}

TEST(Convert, RefusesHostileFrameStatuses) {
  proto::FramesAnswer message;
  EXPECT_FALSE(ReadFrameStatuses(message)) << "none";
  message.add_frames()->set_file("short");
  EXPECT_FALSE(ReadFrameStatuses(message));
  message.clear_frames();
  for (int i = 0; i < kFramesPerJobMax; ++i) message.add_frames();
  EXPECT_TRUE(ReadFrameStatuses(message));
  message.add_frames();
  EXPECT_FALSE(ReadFrameStatuses(message)) << "too many";
}

}  // namespace
}  // namespace tessera
