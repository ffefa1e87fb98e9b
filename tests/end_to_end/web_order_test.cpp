// Jobs that are submitted over HTTP, whose frames a worker makes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <signal.h>

#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "proto/scene_package.h"
#include "renderer/util/digest.h"
#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class WebOrdersOfAFarm : public EndToEnd {
 protected:
  void StartWithPage() {
    StartCoordinator({"--http", "127.0.0.1:0"});
    const std::string words = "http://127.0.0.1:";
    ASSERT_TRUE(coordinator().AwaitErrors(words));
    const std::string log = coordinator().Errors();
    client_ =
        std::make_unique<httplib::Client>("127.0.0.1", std::stoi(log.substr(log.find(words) + words.size())));
    client_->set_read_timeout(60);
    proof_ = json::parse(client_->Get("/api/v1/me")->body)["proof"];
  }
  // Ends the coordinator as a crash does, and starts it again with its data.
  void Crash() {
    coordinator().Signal(SIGKILL);
    EXPECT_EQ(coordinator().Wait(), -SIGKILL);
    StartWithPage();
  }
  // Uploads the files and submits the scene file that is named. Returns the job.
  std::string Order(const std::map<std::string, std::string>& files, const std::string& scene_file) {
    ScenePackage package;
    for (const auto& [path, bytes] : files) package.files[path] = {Upload(bytes), bytes.size()};
    const json order{{"package", Upload(EncodeScenePackage(package)).Hex()},
                     {"scene_file", scene_file},
                     {"options", {{"samples_per_pixel", 4}}}};
    const auto answer =
        client_->Post("/api/v1/jobs", {{"X-Tessera-Proof", proof_}}, order.dump(), "application/json");
    EXPECT_EQ(answer->status, 200) << answer->body;
    return json::parse(answer->body)["id"].dump();
  }
  json StatusOf(const std::string& job) const { return json::parse(Ask({"status", job, "--json"}).output); }

 private:
  Digest Upload(const std::string& bytes) {
    const Digest digest = Sha256(bytes);
    const auto answer = client_->Put("/api/v1/blobs/" + digest.Hex(), {{"X-Tessera-Proof", proof_}}, bytes,
                                     "application/octet-stream");
    EXPECT_TRUE(answer && answer->status < 300) << bytes.size();
    return digest;
  }
  std::unique_ptr<httplib::Client> client_;
  std::string proof_;
};

std::string BytesOfFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(WebOrdersOfAFarm, SurviveCrashesOfTheCoordinatorAndHaveTheBitsOfOneProcess) {
  const std::string oracle = Oracle(BoxScene(), {"--spp", "4"});
  StartWithPage();
  const std::string scenes = SourceDir() + "/tests/scenes/";
  const std::string job = Order({{"box.pbrt", BytesOfFile(scenes + "box.pbrt")},
                                 {"box-walls.pbrt", BytesOfFile(scenes + "box-walls.pbrt")}},
                                "box.pbrt");
  EXPECT_EQ(StatusOf(job)["state"], "preparing");
  Crash();
  EXPECT_EQ(StatusOf(job)["state"], "preparing");
  // A member may fetch the files of open jobs alone.
  const Outcome token =
      RunProgram(folder(), "tessera-coordinator", {"token", "--role", "worker", "--coordinator", address()});
  ASSERT_EQ(token.code, 0) << token.errors;
  Process& worker = StartUnaddressedWorker("only", {"--threads", "1", "--state-dir", Path("state"), "--join",
                                                    token.output.substr(0, token.output.find('\n'))});
  ASSERT_TRUE(worker.AwaitErrors("scene_prepared"));
  // The report may have been answered, be on its way or not be sent yet.
  Crash();
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  const Outcome fetched = Ask({"fetch", job, "-o", "picture.exr"});
  ASSERT_EQ(fetched.code, 0) << fetched.errors;
  EXPECT_TRUE(Bytes("picture.exr") == oracle);
}

TEST_F(WebOrdersOfAFarm, EndWithThePlaceOfTheMistakeIfNoWorkerCanReadTheScene) {
  StartWithPage();
  for (const char* name : {"first", "second", "third"}) StartWorker(name);
  const std::string job = Order({{"scene.pbrt", "WorldBegin\nInclude \"parts/part.pbrt\"\n"},
                                 {"parts/part.pbrt", "Material \"diffuse\"\n  Shape \"cube\"\n"}},
                                "scene.pbrt");
  const Outcome watched = Ask({"watch", job});
  EXPECT_NE(watched.code, 0);
  EXPECT_THAT(watched.errors, testing::ContainsRegex("parts/part.pbrt:2:[0-9]+: "));
  const json status = StatusOf(job);
  EXPECT_EQ(status["state"], "failed");
  EXPECT_THAT(std::string(status["reason"]), HasSubstr("first, second, third: parts/part.pbrt:2:"));
  EXPECT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 1);
}

}  // namespace
}  // namespace tessera
