// The commands of tessera against a real farm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using Commands = EndToEnd;

// A render that does not end during a test.
const std::vector<std::string> kEndless{"--spp", "100000"};

TEST_F(Commands, SubmitWatchAndFetchGiveThePicture) {
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit(BoxScene(), {"--name", "little box", "--priority", "3"});
  const Outcome watched = Ask({"watch", job, "--json"});
  EXPECT_EQ(watched.code, 0) << watched.errors;
  EXPECT_THAT(watched.output, HasSubstr("\"state\":\"finished\""));
  EXPECT_THAT(watched.errors, HasSubstr("samples/s"));
  const Outcome status = Ask({"status", job});
  EXPECT_EQ(status.code, 0);
  EXPECT_THAT(status.output,
              HasSubstr("job " + job + " \"little box\", owner local, priority 3: finished  100.0 %"));
  const Outcome jobs = Ask({"jobs"});
  EXPECT_THAT(jobs.output, HasSubstr("little box"));
  EXPECT_THAT(Ask({"jobs", "--json"}).output, HasSubstr("\"priority\":3"));
  EXPECT_THAT(Ask({"workers"}).output, HasSubstr("only"));
  EXPECT_THAT(Ask({"workers", "--json"}).output, HasSubstr("\"name\":\"only\",\"slots\":1"));
  const Outcome fetched = Ask({"fetch", job, "--png", "picture.png"});
  EXPECT_EQ(fetched.code, 0) << fetched.errors;
  EXPECT_EQ(fetched.output, "job-" + job + ".exr\n");
  EXPECT_EQ(Bytes("picture.png").substr(1, 3), "PNG");
  EXPECT_TRUE(Bytes("job-" + job + ".exr") == Oracle(BoxScene(), {}));
}

TEST_F(Commands, SubmitWithWatchEndsWithTheJob) {
  StartCoordinator();
  StartWorker("only");
  const Outcome outcome = Ask({"submit", BoxScene(), "--watch", "--json"});
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_EQ(outcome.output, "{\"job\":1}\n");
  EXPECT_THAT(outcome.errors, HasSubstr("100.0 %"));
}

TEST_F(Commands, AnUnfinishedPictureIsFetchedOnlyAsAPreview) {
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit(BoxScene(), kEndless);
  AwaitShare(job, 0);
  const Outcome fetched = Ask({"fetch", job, "-o", "picture.exr"});
  EXPECT_EQ(fetched.code, 1) << fetched.errors;
  EXPECT_THAT(fetched.errors, HasSubstr("not finished"));
  EXPECT_FALSE(Exists("picture.exr"));
  const Outcome preview = Ask({"fetch", job, "--preview", "-o", "picture.exr"});
  EXPECT_EQ(preview.code, 0) << preview.errors;
  EXPECT_EQ(Tessera({"compare", "picture.exr", "picture.exr"}).code, 0);
}

TEST_F(Commands, CancelEndsAJobAndTheCommandsThatWatchIt) {
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit(BoxScene(), kEndless);
  Process watch(folder(), "tessera", {"watch", job, "--coordinator", address()});
  AwaitShare(job, 0);
  const Outcome cancelled = Ask({"cancel", job, "--json"});
  EXPECT_EQ(cancelled.code, 0) << cancelled.errors;
  EXPECT_THAT(cancelled.output, HasSubstr("\"state\":\"cancelled\""));
  EXPECT_EQ(watch.Wait(), 1);
  EXPECT_THAT(watch.Errors(), HasSubstr("was cancelled"));
  // The worker is free for the next job.
  EXPECT_EQ(Ask({"submit", BoxScene(), "--watch"}).code, 0);
}

TEST_F(Commands, WhatWasRenderedOfACancelledJobCanBeFetched) {
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit(BoxScene(), kEndless);
  AwaitShare(job, 0);
  const Outcome cancelled = Ask({"cancel", job});
  EXPECT_EQ(cancelled.code, 0) << cancelled.errors;
  EXPECT_THAT(cancelled.output + Ask({"status", job}).output, Not(HasSubstr("left")));
  const Outcome fetched = Ask({"fetch", job, "-o", "picture.exr"});
  EXPECT_EQ(fetched.code, 1);
  EXPECT_THAT(fetched.errors, HasSubstr("the job was cancelled; use --preview"));
  EXPECT_FALSE(Exists("picture.exr"));
  const Outcome preview = Ask({"fetch", job, "--preview", "-o", "picture.exr"});
  EXPECT_EQ(preview.code, 0) << preview.errors;
  EXPECT_EQ(Tessera({"compare", "picture.exr", "picture.exr"}).code, 0);
  coordinator().Signal(SIGKILL);
  coordinator().Wait();
  StartCoordinator();
  EXPECT_EQ(Ask({"fetch", job, "--preview", "-o", "again.exr"}).code, 0) << "after a crash";
  EXPECT_TRUE(Bytes("again.exr") == Bytes("picture.exr"));
}

TEST_F(Commands, NothingIsFetchedOfAJobOfWhichNothingWasRendered) {
  StartCoordinator();
  const std::string job = Submit(BoxScene(), {});
  EXPECT_EQ(Ask({"cancel", job}).code, 0);
  const Outcome fetched = Ask({"fetch", job});
  EXPECT_EQ(fetched.code, 1);
  EXPECT_THAT(fetched.errors, HasSubstr("the job was cancelled"));
  EXPECT_THAT(fetched.errors, Not(HasSubstr("--preview"))) << "it could not work";
  const Outcome preview = Ask({"fetch", job, "--preview"});
  EXPECT_EQ(preview.code, 1);
  EXPECT_THAT(preview.errors, HasSubstr("nothing was rendered of frame 0 of job " + job));
}

TEST_F(Commands, AnUnknownJobIsBadInput) {
  StartCoordinator();
  for (const char* command : {"status", "watch", "cancel", "fetch"}) {
    const Outcome outcome = Ask({command, "77"});
    EXPECT_EQ(outcome.code, 2) << command << outcome.errors;
    EXPECT_THAT(outcome.errors, HasSubstr("77")) << command;
  }
}

class InterruptedCommands : public Commands, public testing::WithParamInterface<int> {};

TEST_P(InterruptedCommands, ARenderLeavesNoFilesOrProcesses) {
  for (const char* way : {"--in-process", "--workers=2"}) {
    Process render(folder(), "tessera", {"render", BoxScene(), "-o", "picture.exr", way, "--spp", "100000"});
    const size_t children = std::string_view(way) == "--in-process" ? 0 : 3;
    std::vector<pid_t> pids;
    ASSERT_TRUE(Eventually([&] { return (pids = ChildrenOf(render.pid())).size() == children; }));
    ASSERT_TRUE(Eventually([&] { return render.Errors().find(" 0.0 %") != std::string::npos; }));
    render.Signal(GetParam());
    EXPECT_EQ(render.Wait(std::chrono::seconds(10)), 130) << render.Errors();
    for (pid_t pid : pids) EXPECT_FALSE(IsAlive(pid));
    EXPECT_TRUE(std::filesystem::is_empty(Path("tmp")));
    EXPECT_FALSE(Exists("picture.exr"));
    EXPECT_THAT(render.Errors(), HasSubstr("interrupted"));
  }
}

INSTANTIATE_TEST_SUITE_P(BySignal, InterruptedCommands, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT));

TEST_F(Commands, ARenderWhoseMessagesNobodyReadsGoesOnAndLeavesNoFilesOrProcesses) {
  // After one line nobody reads the messages any more.
  const Outcome outcome = RunShell(folder(), "$tessera render " + BoxScene() +
                                                 " --workers 2 --spp 4 -o p.exr 2>&1 | head -n 1; "
                                                 "exit ${PIPESTATUS[0]}");
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_TRUE(Exists("p.exr"));
  EXPECT_TRUE(std::filesystem::is_empty(Path("tmp")));
}

TEST_F(Commands, TheProcessesOfAKilledRenderEnd) {
  std::vector<pid_t> pids;
  Process render(folder(), "tessera", {"render", BoxScene(), "--workers", "2", "--spp", "100000"});
  ASSERT_TRUE(Eventually([&] { return (pids = ChildrenOf(render.pid())).size() == 3; }));
  render.Signal(SIGKILL);
  EXPECT_EQ(render.Wait(), -SIGKILL);
  for (pid_t pid : pids) EXPECT_TRUE(Eventually([&] { return !IsAlive(pid); }));
}

TEST_F(Commands, ARenderWhoseWorkersAllEndFails) {
  Process render(folder(), "tessera", {"render", BoxScene(), "--workers", "1", "--spp", "100000"});
  std::vector<pid_t> workers;
  ASSERT_TRUE(Eventually([&] { return (workers = ChildrenOf(render.pid(), "tessera-worker")).size() == 1; }));
  ::kill(workers[0], SIGKILL);
  EXPECT_EQ(render.Wait(), 1);
  EXPECT_THAT(render.Errors(), HasSubstr("no worker is left: worker 1 ended with signal 9"));
}

TEST_F(Commands, RenderNamesThePictureAfterTheSceneAndReplacesAnExistingFile) {
  Write("box.exr", "something else");
  const Outcome outcome = Tessera({"render", BoxScene(), "--spp", "1", "--json", "--png", "box.png"});
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("{\"output\":\"box.exr\",\"sha256\":\""));
  EXPECT_TRUE(Bytes("box.exr") == Oracle(BoxScene(), {"--spp", "1"}));
  EXPECT_EQ(Bytes("box.png").substr(1, 3), "PNG");
  EXPECT_THAT(outcome.errors, HasSubstr("samples/s"));
}

TEST_F(Commands, ALocalFarmNotesThatThisMachineHasPassedTheProbe) {
  const std::vector<std::string> render{"render", BoxScene(), "-o", "picture.exr", "--workers", "2"};
  ASSERT_EQ(Tessera(render).code, 0);
  const std::string note = "user-cache/tessera-probe/passed";
  EXPECT_THAT(Bytes(note), HasSubstr("passed "));
  const std::string picture = Bytes("picture.exr");
  // What is damaged is replaced, and what is whole is used.
  std::ofstream(Path(note)) << "passed";
  for (int again = 0; again < 2; ++again) {
    ASSERT_EQ(Tessera(render).code, 0);
    EXPECT_TRUE(Bytes("picture.exr") == picture);
    EXPECT_GT(Bytes(note).size(), 128u);
  }
}

TEST_F(Commands, ASceneIsReadFromStandardInput) {
  Write("walls.pbrt", "Shape \"sphere\"\n");
  Write(
      "scene.pbrt",
      "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 8 Camera \"perspective\"\nWorldBegin\n"
      "LightSource \"infinite\"\nTranslate 0 0 4 Include \"walls.pbrt\"\n");
  const auto pixels = [&](const std::string& name) { return Tessera({"compare", name, "file.exr"}); };
  ASSERT_EQ(Tessera({"render", "scene.pbrt", "-o", "file.exr", "--spp", "2", "--in-process"}).code, 0);
  for (const std::string way : {"--in-process", "--workers=1"}) {
    for (const std::string feed : {"cat scene.pbrt", "gzip -c scene.pbrt"}) {
      const Outcome outcome = RunShell(folder(), feed + " | $tessera render - --spp 2 " + way);
      EXPECT_EQ(outcome.code, 0) << outcome.errors;
      EXPECT_THAT(outcome.errors, HasSubstr("stdin.exr: rendered in"));
      EXPECT_EQ(pixels("stdin.exr").code, 0) << feed << way;
      std::filesystem::remove(Path("stdin.exr"));
    }
  }
  const Outcome frames =
      RunShell(folder(), "$tessera render - --frames 1-2 --spp 2 --in-process < scene.pbrt");
  EXPECT_EQ(frames.code, 0) << frames.errors;
  EXPECT_EQ(pixels("stdin.0002.exr").code, 0);
  EXPECT_THAT(RunShell(folder(), "$tessera info - < scene.pbrt").output, HasSubstr("16x8 pixels"));
  const Outcome bad = RunShell(folder(), "echo Nonsense | $tessera render - --in-process");
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.errors, HasSubstr("<stdin>:1:1: "));
  StartCoordinator();
  StartWorker("only");
  const Outcome job =
      RunShell(folder(), "$tessera submit - --spp 2 --watch --coordinator " + address() + " < scene.pbrt");
  EXPECT_EQ(job.code, 0) << job.errors;
  EXPECT_THAT(Ask({"jobs"}).output, HasSubstr("stdin"));
  EXPECT_EQ(Ask({"fetch", "1", "-o", "farm.exr"}).code, 0);
  EXPECT_EQ(pixels("farm.exr").code, 0);
}

TEST_F(Commands, ComparePrintsTheDifferenceOfTwoPictures) {
  Oracle(BoxScene(), {"--spp", "4"});
  std::filesystem::rename(Path("oracle.exr"), Path("a.exr"));
  Oracle(BoxScene(), {"--spp", "4", "--seed", "9"});
  const Outcome same = Tessera({"compare", "a.exr", "a.exr"});
  EXPECT_EQ(same.code, 0);
  EXPECT_EQ(same.output, "mse=0 relmse=0 psnr=inf maxabs=0 identical=yes flip=0\n");
  const Outcome different = Tessera({"compare", "a.exr", "oracle.exr"});
  EXPECT_EQ(different.code, 1);
  EXPECT_THAT(different.output, HasSubstr("identical=no"));
  EXPECT_EQ(Tessera({"compare", "a.exr", "oracle.exr", "--tolerance", "100000"}).code, 0);
  EXPECT_EQ(Tessera({"compare", "a.exr", "nothing.exr"}).code, 2);
}

TEST_F(Commands, CompareLooksAtOneLayerAndDrawsTheErrors) {
  Oracle(BoxScene(), {"--spp", "4", "--aov", "albedo,depth"});
  std::filesystem::rename(Path("oracle.exr"), Path("a.exr"));
  Oracle(BoxScene(), {"--spp", "4", "--seed", "9", "--aov", "albedo"});
  const Outcome colors = Tessera({"compare", "a.exr", "oracle.exr", "--layer", "RGB", "--json"});
  const auto json = nlohmann::json::parse(colors.output);
  EXPECT_GT(json["flip"], 0);
  EXPECT_LT(json["flip"], 1);
  EXPECT_GE(json["flip_exposures"]["count"], 2);
  const Outcome depth =
      Tessera({"compare", "a.exr", "a.exr", "--layer", "depth", "--difference", "depth.png"});
  EXPECT_EQ(depth.code, 0) << depth.errors;
  EXPECT_EQ(depth.output, "mse=0 relmse=0 psnr=inf maxabs=0 identical=yes\n");
  EXPECT_EQ(Bytes("depth.png").substr(1, 3), "PNG");
  EXPECT_EQ(Tessera({"compare", "a.exr", "oracle.exr", "--difference", "rgb.png"}).code, 1);
  EXPECT_EQ(Bytes("rgb.png").substr(1, 3), "PNG");
  const Outcome missing = Tessera({"compare", "a.exr", "oracle.exr", "--layer", "depth"});
  EXPECT_EQ(missing.code, 2);
  EXPECT_THAT(missing.errors, HasSubstr("oracle.exr: no layer \"depth\"; it has RGB, albedo"));
  std::filesystem::copy(Path("a.exr"), Path("a.png"));
  const Outcome input = Tessera({"compare", "a.png", "oracle.exr", "--difference", "a.png"});
  EXPECT_EQ(input.code, 2);
  EXPECT_THAT(input.errors, HasSubstr("a.png: the command reads this file"));
}

TEST_F(Commands, DenoiseNamesTheLayersThatAPictureLacks) {
  Oracle(BoxScene(), {"--spp", "8", "--aov", "albedo,depth"});
  const Outcome refused = Tessera({"denoise", "oracle.exr", "-o", "denoised.exr"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("oracle.exr: cannot be denoised without the layers normal, halves"));
  EXPECT_FALSE(Exists("denoised.exr"));
  EXPECT_EQ(Tessera({"denoise", "oracle.exr", "-o", "oracle.exr"}).code, 2) << "it would overwrite its input";
}

TEST_F(Commands, InfoDescribesAScene) {
  const Outcome text = Tessera({"info", BoxScene()});
  EXPECT_EQ(text.code, 0) << text.errors;
  EXPECT_THAT(text.output, HasSubstr("96x72 pixels, 16 samples per pixel"));
  EXPECT_THAT(text.output, HasSubstr("files       2,"));
  EXPECT_THAT(text.output, ContainsRegex("  embree +built in .* s, .* bytes"));
  EXPECT_THAT(text.output, ContainsRegex("  bvh +built in .* s, .* bytes, .* nodes, surface area cost"));
  EXPECT_THAT(text.output, ContainsRegex("  list +built in .* s, .* bytes, surface area cost"));
  const Outcome json = Tessera({"info", BoxScene(), "--json", "--spp", "3"});
  EXPECT_THAT(json.output, HasSubstr("\"samples_per_pixel\":3"));
  EXPECT_THAT(json.output, HasSubstr("{\"path\":\"box-walls.pbrt\""));
  const Outcome of_one = Tessera({"info", BoxScene(), "--accelerator", "bvh"});
  EXPECT_THAT(of_one.output, HasSubstr("  bvh "));
  EXPECT_THAT(of_one.output, Not(HasSubstr("  embree ")));
}

}  // namespace
}  // namespace tessera
