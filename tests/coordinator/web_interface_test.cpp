// The web interface of a real farm: who may do what, changes, pictures and downloads.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "renderer/film/picture_file.h"
#include "tests/coordinator/no_file_grows.h"
#include "tests/coordinator/web/api/shown_picture.h"
#include "tests/coordinator/web/tls_client.h"
#include "tests/coordinator/web_services_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class WebInterface : public WebServices {
 protected:
  json Get(const std::string& path) {
    const auto answer = client->Get("/api/v1/" + path);
    EXPECT_EQ(answer->status, 200) << answer->body;
    return json::parse(answer->body, nullptr, false);
  }
  int StatusOf(const std::string& path, const json& body = json::object()) {
    return Post(path, body)->status;
  }
  std::string JobPath(uint64_t job, const std::string& rest = "") const {
    return fmt::format("jobs/{}{}", job, rest);
  }
  // Receives the picture until `is_enough`.
  template <typename Condition>
  ShownPicture Watch(uint64_t job, Condition is_enough, const std::string& query = "") {
    ShownPicture picture;
    std::string pending;
    client->Get("/api/v1/" + JobPath(job, "/picture" + query), [&](const char* bytes, size_t size) {
      pending.append(bytes, size);
      pending.erase(0, picture.Read(pending));
      return !is_enough(picture);
    });
    return picture;
  }
};

TEST_F(WebInterface, ChangesAJobAsTheCallsDo) {
  const uint64_t job = Submit();
  EXPECT_EQ(Get(JobPath(job))["state"], "waiting");
  EXPECT_EQ(StatusOf(JobPath(job, "/pause")), 200);
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_PAUSED);
  EXPECT_EQ(StatusOf(JobPath(job, "/resume")), 200);
  EXPECT_EQ(StatusOf(JobPath(job, "/priority"), {{"priority", 7}}), 200);
  EXPECT_EQ(Status(job).priority(), 7);
  EXPECT_EQ(StatusOf(JobPath(job, "/priority"), {{"priority", 1'000'001}}), 400);
  EXPECT_EQ(StatusOf(JobPath(job, "/extend"), {{"samples_per_pixel", 8}}), 409)
      << "its sampler cannot be extended";
  EXPECT_EQ(StatusOf(JobPath(job, "/extend"), {{"samples_per_pixel", 0}}), 400);
  EXPECT_EQ(StatusOf(JobPath(job, "/cancel")), 200);
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_CANCELLED);
  EXPECT_EQ(StatusOf(JobPath(job, "/pause")), 409);
  EXPECT_EQ(StatusOf(JobPath(99, "/pause")), 404);
  EXPECT_EQ(StatusOf("workers/00000000000000ff/drain"), 404);
}

TEST_F(WebInterface, WithoutTheProofNothingChanges) {
  const uint64_t job = Submit();
  const auto refused = client->Post("/api/v1/" + JobPath(job, "/cancel"), "{}", "application/json");
  EXPECT_EQ(refused->status, 403);
  EXPECT_NE(Status(job).state(), proto::JOB_STATE_CANCELLED);
}

TEST_F(WebInterface, ThePictureRefinesToTheValuesOfItsFile) {
  const uint64_t job = Submit();
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(job, 0, {0, 4}, answer, 0.3f).ok());
  const ShownPicture half_done = Watch(job, [](const ShownPicture& shown) { return shown.samples_done > 0; });
  EXPECT_FALSE(half_done.is_finished);
  EXPECT_EQ(half_done.values[0], 0.3f);
  EXPECT_EQ(half_done.values[3 * 8], 0.0f);
  const auto preview = client->Get("/api/v1/" + JobPath(job, "/picture.exr"));
  EXPECT_EQ(preview->status, 200);
  ASSERT_TRUE(Return(job, 1, {0, 4}, answer, 0.7f).ok());
  const ShownPicture done = Watch(job, [](const ShownPicture& shown) { return shown.is_finished; });
  std::string file;
  EXPECT_TRUE(ComesTrue([&] {
    file.clear();
    return Fetch(job, false, file).ok();
  }));
  const auto download = client->Get("/api/v1/" + JobPath(job, "/picture.exr"));
  EXPECT_EQ(download->body, file) << "the same bytes as tessera fetch";
  EXPECT_EQ(download->get_header_value("Content-Disposition"),
            fmt::format("attachment; filename=\"job-{}.exr\"", job));
  const auto picture = DecodeExr(file, "picture");
  ASSERT_TRUE(picture);
  const size_t channels = picture->channels.size();
  constexpr const char* kNames[] = {"R", "G", "B"};
  for (size_t c = 0; c < 3; ++c) {
    const auto place =
        static_cast<size_t>(std::ranges::find(picture->channels, kNames[c]) - picture->channels.begin());
    for (size_t i = 0; i < 16 * 8; ++i)
      EXPECT_EQ(done.values[3 * i + c], picture->values[channels * i + place]);
  }
  EXPECT_EQ(client->Get("/api/v1/" + JobPath(job, "/picture.png"))->body.substr(1, 3), "PNG");
}

TEST_F(WebInterface, LayersAreThoseOfTheFrameAndProgressIsShown) {
  const uint64_t job = Submit();
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(job, 0, {0, 4}, answer, 0.3f).ok());
  const json detail = Get(JobPath(job));
  ASSERT_EQ(detail["layers"].size(), 3u);
  EXPECT_EQ(detail["layers"][0]["channels"], json::parse(R"(["R","G","B"])"));
  EXPECT_EQ(client->Get("/api/v1/" + JobPath(job, "/picture?layer=albedo"))->status, 404);
  const auto is_there = [](const ShownPicture& shown) { return shown.samples_done > 0; };
  const ShownPicture samples = Watch(job, is_there, "?layer=~samples");
  EXPECT_EQ(samples.shape.channels, 1u);
  EXPECT_EQ(samples.values[0], 4);
  EXPECT_EQ(samples.values[8], 0) << "the second tile has none";
}

// Reading goes on, and whoever changes something gets the reason.
TEST_F(WebInterface, OnAFullDiskThePageShowsTheFarmAndTheReason) {
  const uint64_t job = Submit();
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(job, 0, {0, 4}, answer, 0.3f).ok());
  {
    const NoFileGrows full;
    const auto refused = Post(JobPath(job, "/pause"));
    EXPECT_EQ(refused->status, 503);
    EXPECT_THAT(refused->body, HasSubstr("the coordinator cannot write its data"));
    EXPECT_EQ(client->Get("/")->status, 200);
    EXPECT_EQ(client->Get("/api/v1/" + JobPath(job))->status, 200);
    const ShownPicture shown = Watch(job, [](const ShownPicture& each) { return each.samples_done > 0; });
    EXPECT_EQ(shown.values[0], 0.3f);
    const auto download = client->Get("/api/v1/" + JobPath(job, "/picture.exr"));
    EXPECT_EQ(download->status, 503) << "it needs a temporary file";
    EXPECT_TRUE(json::parse(download->body)["error"].is_string());
    EXPECT_EQ(client->Get("/api/v1/" + JobPath(job, "/log"))->status, 200);
  }
  EXPECT_TRUE(ComesTrue([&] { return StatusOf(JobPath(job, "/resume")) == 200; })) << "there is space again";
}

TEST_F(WebInterface, AFinishedPictureIsDownloadedFromAFullDiskAsItIs) {
  const uint64_t job = Submit();
  proto::ResultsAnswer answer;
  for (const uint32_t tile : {0u, 1u}) ASSERT_TRUE(Return(job, tile, {0, 4}, answer, 0.3f).ok());
  std::string file;
  ASSERT_TRUE(ComesTrue([&] {
    file.clear();
    return Fetch(job, false, file).ok();
  }));
  const NoFileGrows full;
  const auto download = client->Get("/api/v1/" + JobPath(job, "/picture.exr"));
  EXPECT_EQ(download->status, 200);
  EXPECT_TRUE(download->body == file);
  EXPECT_EQ(client->Get("/api/v1/" + JobPath(job, "/picture.png"))->status, 503) << "it has to be made";
}

TEST_F(WebInterface, ASmallPictureIsMadeSoonAfterItIsFirstAskedFor) {
  const uint64_t job = Submit();
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(job, 0, {0, 4}, answer).ok());
  EXPECT_TRUE(
      ComesTrue([&] { return client->Get("/api/v1/" + JobPath(job, "/thumbnail.png"))->status == 200; }));
  EXPECT_EQ(client->Get("/api/v1/" + JobPath(99, "/thumbnail.png"))->status, 404);
  EXPECT_EQ(client->Get("/api/v1/" + JobPath(job, "/thumbnail.png?frame=1"))->status, 404);
}

TEST_F(WebInterface, ManyWatchersOfAPictureShareItsWork) {
  const uint64_t job = Submit();
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(job, 0, {0, 4}, answer, 0.3f).ok());
  std::vector<int> watchers;
  for (int i = 0; i < 50; ++i) {
    watchers.push_back(ConnectTo(port()));
    const std::string request =
        fmt::format("GET /api/v1/jobs/{}/picture HTTP/1.1\r\nHost: localhost\r\n\r\n", job);
    ::send(watchers.back(), request.data(), request.size(), MSG_NOSIGNAL);
  }
  for (const int watcher : watchers) {
    std::string received;
    char bytes[4096];
    ssize_t size = 0;
    while (received.find("TPIX\x01\x03") == std::string::npos &&
           (size = ::recv(watcher, bytes, sizeof bytes, 0)) > 0)
      received.append(bytes, static_cast<size_t>(size));
    EXPECT_THAT(received, HasSubstr("TPIX\x01\x03"));
  }
  EXPECT_TRUE(ComesTrue([&] { return Get("farm")["jobs_total"] == 1; }));
  for (const int watcher : watchers) ::close(watcher);
}

TEST_F(WebInterface, ShowsTheUnitsThatWorkersHave) {
  const uint64_t job = Submit();
  proto::WorkerDirective directive;
  WorkerState state = Worker(milliseconds(5000));
  state.scenes = {{scene_key, true, false}};
  ASSERT_TRUE(Synchronize(state, directive).ok());
  const json detail = Get(JobPath(job));
  ASSERT_FALSE(detail["units"].empty());
  EXPECT_EQ(detail["units"][0]["worker"], "0000000000000007");
  EXPECT_EQ(detail["width"], 16);
  EXPECT_EQ(detail["frames"], json::parse("[[0,false]]"));
  EXPECT_EQ(StatusOf("workers/0000000000000007/drain"), 200);
  EXPECT_TRUE(ComesTrue([&] {
    const json workers = Get("workers")["workers"];
    return workers.size() == 1 && workers[0]["state"] == "draining";
  }));
}

}  // namespace
}  // namespace tessera
