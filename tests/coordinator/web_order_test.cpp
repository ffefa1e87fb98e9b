// Jobs that are submitted over the web interface.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/coordinator/no_file_grows.h"
#include "tests/coordinator/web_services_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class WebOrders : public WebServices {
 protected:
  WebOrders() {
    submitted = PrepareJob();
    order = {{"package", ReadDigest(submitted.package(), "package")->Hex()}, {"scene_file", "scene.pbrt"}};
  }
  httplib::Result SubmitOrder(const json& body) { return Post("jobs", body); }
  int StatusOf(const json& body) { return SubmitOrder(body)->status; }

  proto::JobSpec submitted;
  json order;
};

TEST_F(WebOrders, AJobIsPreparedByAWorkerAndIsThenLikeAnyOther) {
  order.update({{"name", "from the page"},
                {"priority", 4},
                {"options", {{"samples_per_pixel", 4}, {"denoise", false}}}});
  const auto answer = SubmitOrder(order);
  ASSERT_EQ(answer->status, 200) << answer->body;
  const json shown = json::parse(answer->body);
  EXPECT_EQ(shown["state"], "preparing");
  EXPECT_EQ(shown["owner"], "local");
  const uint64_t job = shown["id"];
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_PREPARING);
  const auto request = AwaitPreparation();
  EXPECT_EQ(request.scene_file(), "scene.pbrt");
  EXPECT_EQ(request.options(), "spp=4\n");
  proto::PreparationReport report;
  *report.add_frames() = submitted.frames(0);
  EXPECT_TRUE(Report(report, request).ok());
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_PREPARING) << "its options are not those ordered";
  EXPECT_THAT(Status(job).reason(), HasSubstr("not ordered"));
}

TEST_F(WebOrders, TheFramesOfAWorkerMakeTheJobThatAClientWouldSubmit) {
  const json shown = json::parse(SubmitOrder(order)->body);
  const auto request = AwaitPreparation();
  proto::PreparationReport report;
  *report.add_frames() = submitted.frames(0);
  EXPECT_TRUE(Report(report, request).ok());
  const auto status = Status(shown["id"]);
  EXPECT_EQ(status.state(), proto::JOB_STATE_WAITING);
  EXPECT_EQ(status.samples_total(), 16u * 8 * 4);
  proto::ResultsAnswer answer;
  EXPECT_TRUE(Return(shown["id"], 0, {0, 4}, answer).ok());
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::ACCEPTED);
}

TEST_F(WebOrders, AnOrderSurvivesARestart) {
  const uint64_t job = json::parse(SubmitOrder(order)->body)["id"];
  Restart();
  EXPECT_EQ(Status(job).state(), proto::JOB_STATE_PREPARING);
  proto::PreparationReport report;
  report.set_reason("scene.pbrt:3:1: unknown directive");
  EXPECT_TRUE(Report(report, AwaitPreparation()).ok());
  EXPECT_THAT(Status(job).reason(), HasSubstr("scene.pbrt:3:1: unknown directive"));
  proto::JobRequest cancel;
  cancel.set_job(job);
  proto::JobStatus cancelled;
  EXPECT_TRUE(Call(*jobs, &proto::Jobs::Stub::Cancel, cancel, cancelled).ok());
  EXPECT_EQ(cancelled.state(), proto::JOB_STATE_CANCELLED);
  proto::FramesAnswer frames;
  EXPECT_EQ(Call(*jobs, &proto::Jobs::Stub::Frames, cancel, frames).error_code(),
            grpc::StatusCode::FAILED_PRECONDITION);
}

TEST_F(WebOrders, TheSameSubmissionIsTheSameJob) {
  order["submission"] = 77;
  const json first = json::parse(SubmitOrder(order)->body), second = json::parse(SubmitOrder(order)->body);
  EXPECT_EQ(first["id"], second["id"]);
  order["submission"] = 78;
  EXPECT_NE(json::parse(SubmitOrder(order)->body)["id"], first["id"]);
}

TEST_F(WebOrders, WhatCannotBeRenderedIsRefusedByName) {
  const auto with = [&](const char* name, const json& value) {
    json body = order;
    body[name] = value;
    return StatusOf(body);
  };
  EXPECT_EQ(with("scene_file", "other.pbrt"), 400);
  EXPECT_EQ(with("scene_file", "../scene.pbrt"), 400);
  EXPECT_EQ(with("scene_file", 5), 400);
  EXPECT_EQ(with("package", "ff"), 400);
  EXPECT_EQ(with("package", Sha256("not uploaded").Hex()), 409);
  EXPECT_EQ(with("package", Sha256("a scene").Hex()), 400) << "it is no manifest";
  EXPECT_EQ(with("priority", 1'000'001), 400);
  EXPECT_EQ(with("priority", 1.5), 400);
  EXPECT_EQ(with("submission", 0), 400);
  EXPECT_EQ(with("submission", UINT64_MAX), 400);
  EXPECT_EQ(with("frames", "5-1"), 400);
  EXPECT_EQ(with("frames", "1-100000"), 400);
  EXPECT_EQ(with("frames_per_second", 0), 400);
  EXPECT_EQ(with("more", 1), 400);
  EXPECT_EQ(with("options", json::array()), 400);
  const std::pair<const char*, json> wrong[] = {{"samples_per_pixel", 0},
                                                {"more", 4},
                                                {"width", 64},
                                                {"height", 1e9},
                                                {"noise_threshold", -1},
                                                {"noise_threshold", "low"},
                                                {"aov", "a\nspp=5"},
                                                {"denoise", 1}};
  for (const auto& [name, value] : wrong) EXPECT_EQ(with("options", {{name, value}}), 400) << name;
  EXPECT_EQ(client->Post("/api/v1/jobs", order.dump(), "application/json")->status, 403)
      << "without the proof";
  const NoFileGrows full;
  EXPECT_EQ(StatusOf(order), 503);
}

}  // namespace
}  // namespace tessera
