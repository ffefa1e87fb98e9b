// The interface for programs on a farm that renders nothing: lists, events, and requests that are wrong.
#include "coordinator/web/api/web_api.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <new>
#include <nlohmann/json.hpp>

#include "coordinator/web/api/json_views.h"
#include "coordinator/web/api/png.h"
#include "tests/coordinator/web/api/synthetic_farm.h"

namespace tessera {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class Interface : public testing::Test {
 protected:
  HttpResponse Send(const std::string& method, const std::string& path, const std::string& query = "",
                    const std::string& body = "", bool is_json = true) {
    HttpRequest request;
    request.method = method;
    request.path = path;
    request.query = query;
    request.body = body;
    request.is_json = is_json;
    HttpResponse response = api_.Answer(request, {{MemberId{1}, "ada", "operator"}, "test", "the proof", ""});
    while (response.later != nullptr) {
      std::promise<void> given;
      response.later->OnGiven([&] { given.set_value(); });
      given.get_future().wait();
      response = *response.later->Take();
    }
    return response;
  }
  json Get(const std::string& path, const std::string& query = "") {
    const HttpResponse response = Send("GET", "/api/v1/" + path, query);
    EXPECT_EQ(response.status, 200) << *response.body;
    return json::parse(*response.body);
  }

  WebApi api_{SyntheticFarm(5000, 1000)};
};

TEST_F(Interface, ListsAreSearchedFilteredSortedAndCut) {
  const json page = Get("jobs", "offset=10&limit=5&sort=id&order=desc");
  EXPECT_EQ(page["total"], 5000);
  ASSERT_EQ(page["jobs"].size(), 5u);
  EXPECT_EQ(page["jobs"][0]["id"], 4990);
  EXPECT_EQ(Get("jobs", "search=SHOT+001+layer+3")["total"], 1);
  EXPECT_EQ(Get("jobs", "search=4711&limit=1")["jobs"][0]["id"], 4711);
  const json open = Get("jobs", "state=open&owner=ada&limit=50");
  EXPECT_FALSE(open["jobs"].empty());
  for (const json& job : open["jobs"]) {
    EXPECT_EQ(job["owner"], "ada");
    EXPECT_THAT(job["state"], testing::AnyOf("running", "waiting", "paused"));
  }
  const json sorted = Get("jobs", "sort=priority&order=desc&limit=2");
  EXPECT_EQ(sorted["jobs"][0]["priority"], 4);
  EXPECT_TRUE(Get("jobs", "offset=4294967295")["jobs"].empty());
  EXPECT_EQ(Get("workers", "search=gpu")["total"], 500);
  EXPECT_EQ(Get("workers", "state=quarantined")["workers"][0]["name"], "blade-0250");
  EXPECT_EQ(Get("workers", "history=1&limit=200")["workers"][0]["history"].size(), 1u);
}

TEST_F(Interface, WrongParametersAreRefusedWithTheirNames) {
  for (const char* query : {"limit=1001", "limit=-1", "offset=x", "sort=colour", "order=up", "unknown=1",
                            "limit=1&limit=2", "search=%", "a=1&b=2&c=3&d=4&e=5&f=6&g=7&h=8&i=9"}) {
    const HttpResponse response = Send("GET", "/api/v1/jobs", query);
    EXPECT_EQ(response.status, 400) << query;
    EXPECT_TRUE(json::parse(*response.body)["error"].is_string());
  }
  EXPECT_EQ(Send("GET", "/api/v1/workers", "history=1&limit=201").status, 400);
  EXPECT_EQ(Send("GET", "/api/v1/jobs/1/picture", "frame=x").status, 400);
  EXPECT_EQ(Send("GET", "/api/v1/events", "job=-1").status, 400);
  EXPECT_EQ(Send("GET", "/api/v1/jobs/1/thumbnail.png", "size=161").status, 400);
  EXPECT_EQ(Send("GET", "/api/v1/jobs/1/thumbnail.png", "size=10000").status, 400);
  EXPECT_EQ(Send("GET", "/api/v1/jobs/1/picture", "layer=unknown").status, 404);
  EXPECT_EQ(Send("GET", "/api/v1/jobs/1/picture", "layer=a&layer=b").status, 400);
}

TEST_F(Interface, BodiesThatAreNotObjectsOfNumbersAreRefused) {
  const std::string path = "/api/v1/jobs/1/priority";
  EXPECT_EQ(Send("POST", path, "", R"({"priority": 7})").status, 200);
  for (const char* body :
       {"", "{}", "[]", "7", "{", R"({"priority": "7"})", R"({"priority": 1e3})", R"({"priority": 1.5})",
        R"({"priority": 99999999999999999999})", R"({"priority": 7, "more": 1})", R"({"priority": {"a": 1}})",
        "{\"priority\": null}"})
    EXPECT_EQ(Send("POST", path, "", body).status, 400) << body;
  EXPECT_EQ(Send("POST", path, "", R"({"priority": 7})", false).status, 400) << "another content type";
  EXPECT_EQ(Send("POST", path, "priority=7", "").status, 400);
  const std::string deep(4000, '[');
  EXPECT_EQ(Send("POST", path, "", deep).status, 400);
}

TEST_F(Interface, TheLogOfAJobIsReadInPages) {
  const json page = Get("jobs/7/log", "limit=2");
  ASSERT_EQ(page["entries"].size(), 2u);
  EXPECT_EQ(page["entries"][0]["level"], "warning");
  EXPECT_EQ(page["entries"][0]["unix_time_ms"], 1'700'000'000'000);
  EXPECT_EQ(Get("jobs/7/log", "after=2")["entries"][0]["number"], 3);
  EXPECT_TRUE(Get("jobs/7/log", "after=18446744073709551615")["entries"].is_array());
  for (const char* query : {"limit=1001", "after=-1", "after=18446744073709551616", "frame=1"})
    EXPECT_EQ(Send("GET", "/api/v1/jobs/7/log", query).status, 400) << query;
  EXPECT_EQ(Send("GET", "/api/v1/jobs/5001/log").status, 404);
}

TEST_F(Interface, UnknownPathsAndMethodsAreRefused) {
  EXPECT_EQ(Send("GET", "/api/v1/nothing").status, 404);
  EXPECT_EQ(Send("GET", "/page/nothing.js").status, 404);
  EXPECT_EQ(Send("GET", "/page/../../etc/passwd").status, 404);
  EXPECT_EQ(Send("GET", "/api/v1/jobs/5001").status, 404);
  EXPECT_EQ(Send("GET", "/api/v1/jobs/1/picture", "frame=3").status, 404);
  const HttpResponse wrong = Send("DELETE", "/api/v1/jobs/1");
  EXPECT_EQ(wrong.status, 405);
  EXPECT_THAT(wrong.Head(), HasSubstr("Allow: GET, HEAD\r\n"));
  EXPECT_EQ(Send("PUT", "/").status, 405);
  EXPECT_EQ(Send("GET", "/api/v1/jobs/1/cancel").status, 405);
}

TEST_F(Interface, BrowsersKeepFilesThatHaveNotChanged) {
  HttpRequest request;
  request.method = "GET";
  request.path = "/page/app.js";
  const HttpResponse file = api_.Answer(request, {});
  EXPECT_THAT(file.Head(), HasSubstr("ETag: \""));
  EXPECT_THAT(file.Head(), HasSubstr("Cache-Control: private, no-cache"));
  request.if_none_match = file.etag;
  const HttpResponse again = api_.Answer(request, {});
  EXPECT_EQ(again.status, 304);
  EXPECT_TRUE(again.body->empty());
  request.if_none_match = "\"other\"";
  EXPECT_EQ(api_.Answer(request, {}).status, 200);
  EXPECT_THAT(Send("GET", "/api/v1/me").Head(), HasSubstr("Cache-Control: no-store"));
}

TEST_F(Interface, ReadersOfEventsShareTheirText) {
  HttpResponse a = Send("GET", "/api/v1/events", "job=7"), b = Send("GET", "/api/v1/events", "job=7");
  std::vector<BodyStream::Part> parts;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (parts.empty() && std::chrono::steady_clock::now() < deadline) a.stream->Take(parts);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_THAT(*parts[0], HasSubstr("event: farm\ndata: {"));
  EXPECT_THAT(*parts[0], HasSubstr("event: job\ndata: {"));
  EXPECT_EQ(a.stream->Take(parts), BodyStream::Next::kLater) << "nothing new";
  std::vector<BodyStream::Part> others;
  b.stream->Take(others);
  ASSERT_EQ(others.size(), 1u);
  EXPECT_TRUE(others[0] == parts[0] || *others[0] != *parts[0]) << "the same text only once";
}

TEST_F(Interface, NamesThatAreNotUtf8AreShownWithReplacements) {
  JobStatus job;
  job.name = "a\xff\n\"<script>";
  const std::string text = JsonText(JobJson(job));
  EXPECT_THAT(text, HasSubstr("a\xef\xbf\xbd\\n\\\"<script>"));
  EXPECT_THAT(text, Not(HasSubstr("\n")));
}

TEST_F(Interface, WhatComesAfterTheEndIsRefused) {
  api_.Stop();
  EXPECT_EQ(Send("GET", "/metrics").status, 503);
}

TEST(Downloads, LackOfMemoryFailsTheDownloadAndTakesNoPlace) {
  WebFarm farm = SyntheticFarm(1, 0);
  farm.frame = [](JobId, uint32_t) -> WebResult<FrameState> { throw std::bad_alloc(); };
  WebApi api(std::move(farm));
  HttpRequest request;
  request.method = "GET";
  request.path = "/api/v1/jobs/1/picture.exr";
  for (int i = 0; i < 40; ++i) {
    const HttpResponse response = api.Answer(request, {});
    ASSERT_NE(response.later, nullptr);
    const auto made = response.later->Take();
    ASSERT_TRUE(made);
    EXPECT_EQ(made->status, 503);
    EXPECT_THAT(*made->body, HasSubstr("the coordinator is out of memory")) << i;
  }
}

TEST(FarmWatch, AFarmThatDoesNotAnswerIsReportedAsBusy) {
  WebFarm farm = SyntheticFarm(0, 0);
  farm.view = [] { return std::optional<FarmView>(); };
  WebApi api(std::move(farm));
  HttpRequest request;
  request.method = "GET";
  request.path = "/metrics";
  const HttpResponse response = api.Answer(request, {});
  std::promise<void> given;
  response.later->OnGiven([&] { given.set_value(); });
  given.get_future().wait();
  EXPECT_EQ(response.later->Take()->status, 503);
}

TEST(FarmWatch, ManyQuestionsShareOneLook) {
  std::atomic<int> looks{0};
  FarmWatch watch([&] {
    ++looks;
    return std::optional(SyntheticView(1, 1));
  });
  for (int i = 0; i < 1000; ++i) {
    std::promise<FarmWatch::Moment> answer;
    watch.Ask([&](const FarmWatch::Moment& moment) { answer.set_value(moment); });
    EXPECT_NE(answer.get_future().get(), nullptr);
  }
  EXPECT_LT(looks, 200);
  EXPECT_EQ(watch.History().size(), 1u);
}

TEST(Png, HasTheSignatureTheSizeAndTheEnd) {
  const std::string png = EncodePng(2, 1, {255, 0, 0, 0, 255, 0});
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png.substr(12, 12), std::string("IHDR\0\0\0\2\0\0\0\1", 12));
  EXPECT_EQ(png.substr(png.size() - 12), std::string("\0\0\0\0IEND\xae\x42\x60\x82", 12));
}

}  // namespace
}  // namespace tessera
