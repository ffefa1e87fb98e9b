// Another data directory at the address that workers know, or the same one restored to an earlier state: its
// job numbers mean other scenes then, and the pictures must not show it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

class Identity : public EndToEnd {
 protected:
  // Spheres that differ in colour alone.
  std::string Sphere(const std::string& color, const std::string& rgb) const {
    return Write(color + ".pbrt",
                 "Film \"rgb\" \"integer xresolution\" 128 \"integer yresolution\" 128\n"
                 "LookAt 0 0 -4 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40\nWorldBegin\n"
                 "LightSource \"infinite\"\nMaterial \"diffuse\" \"rgb reflectance\" [ " +
                     rgb + " ]\nShape \"sphere\"\n");
  }
  std::string Red() const { return Sphere("red", "0.9 0.05 0.05"); }
  std::string Green() const { return Sphere("green", "0.05 0.9 0.05"); }
  void StartFarm() {
    StartCoordinator();
    for (const char* name : {"one", "two"}) workers_.push_back(&StartWorker(name));
  }
  // Every worker holds leases of the job, and results of it are on their way.
  void RenderSome(const std::string& job) const { AwaitShare(job, 0.15); }
  void Kill() {
    coordinator().Signal(SIGKILL);
    EXPECT_EQ(coordinator().Wait(), -SIGKILL);
  }
  void Move(const std::string& from, const std::string& to) const { fs::rename(Path(from), Path(to)); }
  // Seconds from the submission of the job to its end.
  double Render(const std::string& scene, const std::vector<std::string>& options, std::string* job) {
    const auto begin = Clock::now();
    *job = Submit(scene, options);
    EXPECT_EQ(Ask({"watch", *job}).code, 0);
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }
  std::string Fetched(const std::string& job) const {
    const Outcome outcome = Ask({"fetch", job, "-o", "picture.exr"});
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    return Bytes("picture.exr");
  }
  // The farms that the worker has met, in order.
  static std::vector<std::string> FarmsOf(const Process& worker) {
    const std::string log = worker.Errors(), phrase = "connected worker=";
    std::vector<std::string> farms;
    for (size_t at = log.find(" " + phrase); at != std::string::npos; at = log.find(" " + phrase, at + 1)) {
      const size_t farm = log.find("farm=", at);
      farms.push_back(log.substr(farm, log.find('\n', farm) - farm));
    }
    return farms;
  }

  const std::string samples_ = std::to_string(2000 / kSlowdown);
  const std::vector<std::string> options_{"--spp", samples_};
  std::vector<Process*> workers_;
};

TEST_F(Identity, AnotherDataDirectoryAtTheSameAddressGetsItsOwnPixelsInTheUsualTime) {
  const std::string oracle = Oracle(Green(), options_);
  StartFarm();
  RenderSome(Submit(Red(), options_));
  Kill();
  Move("data", "data-of-a");
  StartCoordinator();
  std::string job, again;
  const double seconds = Render(Green(), options_, &job);
  EXPECT_EQ(job, "1") << "the number of the red sphere at the other farm";
  EXPECT_TRUE(Fetched(job) == oracle);
  const double usual_seconds = Render(Green(), {"--spp", samples_, "--seed", "7"}, &again);
  EXPECT_LT(seconds, 3 * usual_seconds + 5 * kSlowdown) << "no lease is waited for";
  for (const Process* const worker : workers_) {
    const auto farms = FarmsOf(*worker);
    ASSERT_GE(farms.size(), 2u) << worker->Errors();
    EXPECT_NE(farms.front(), farms.back());
  }

  // And back: what the first farm had acknowledged is there, and is continued.
  const std::string red = Oracle(Red(), options_);
  Kill();
  Move("data", "data-of-b");
  Move("data-of-a", "data");
  StartCoordinator();
  ASSERT_EQ(Ask({"watch", "1"}).code, 0);
  EXPECT_TRUE(Fetched("1") == red);
}

// The number of the job that is followed is the number of another job there.
TEST_F(Identity, CommandsThatFollowAJobEndWhenAnotherFarmAnswersAtItsAddress) {
  StartFarm();
  Process submitting(folder(), "tessera",
                     {"submit", Red(), "--spp", "20000", "--watch", "--coordinator", address()});
  ASSERT_TRUE(Eventually([&] { return submitting.Output() == "1\n"; }));
  Process watching(folder(), "tessera", {"watch", "1", "--json", "--coordinator", address()});
  ASSERT_TRUE(Eventually([&] { return !watching.Errors().empty(); })) << "it shows the progress";
  Kill();
  Move("data", "data-of-a");
  StartCoordinator();
  ASSERT_EQ(Submit(Green(), {"--spp", "64"}), "1");
  for (Process* const each : {&submitting, &watching}) {
    EXPECT_EQ(each->Wait(), 1);
    EXPECT_THAT(each->Errors(),
                testing::HasSubstr("cannot watch job 1: this address now belongs to another farm ("));
  }
  EXPECT_EQ(watching.Output(), "") << "no status of the other farm's job";
  EXPECT_EQ(Ask({"watch", "1"}).code, 0) << "who connects now follows the other farm's job";
}

// The folders of a spool have the numbers of jobs as their names, and both spools have a job 1.
TEST_F(Identity, ASpoolOfAnotherDataDirectoryDoesNotEnterThePicture) {
  const std::string oracle = Oracle(Green(), options_);
  StartFarm();
  RenderSome(Submit(Red(), options_));
  Kill();
  Move("data", "data-of-a");
  StartCoordinator();
  RenderSome(Submit(Green(), options_));
  Kill();
  fs::remove_all(Path("data/spool"));
  Move("data-of-a/spool", "data/spool");
  StartCoordinator();
  ASSERT_TRUE(coordinator().AwaitErrors("spool_file_ignored"));
  ASSERT_EQ(Ask({"watch", "1"}).code, 0);
  EXPECT_TRUE(Fetched("1") == oracle);
}

TEST_F(Identity, ADirectoryRestoredToAnEarlierStateGetsThePixelsOfItsNewJobs) {
  const std::string oracle = Oracle(Green(), options_);
  StartFarm();
  for (Process* const worker : workers_) ASSERT_TRUE(worker->AwaitErrors(" connected worker="));
  fs::copy(Path("data"), Path("backup"), fs::copy_options::recursive);
  RenderSome(Submit(Red(), options_));
  Kill();
  Move("data", "lost");
  Move("backup", "data");
  StartCoordinator();
  std::string job;
  Render(Green(), options_, &job);
  EXPECT_EQ(job, "1");
  EXPECT_TRUE(Fetched(job) == oracle);
  for (const Process* const worker : workers_) {
    const auto farms = FarmsOf(*worker);
    ASSERT_GE(farms.size(), 2u) << worker->Errors();
    EXPECT_EQ(farms.front(), farms.back()) << "it is the same farm, with another history";
  }
}

}  // namespace
}  // namespace tessera
