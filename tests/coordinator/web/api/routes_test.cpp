// The table of routes, and the description that programs read.
#include "coordinator/web/api/routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "coordinator/page/page_files.h"

namespace tessera {
namespace {

using nlohmann::json;

TEST(WebRoutes, PathsWithNumbersAndIdsAreFound) {
  std::string methods;
  const auto job = FindRoute("GET", "/api/v1/jobs/18446744073709551615", methods);
  ASSERT_TRUE(job);
  EXPECT_EQ(job->route->call, "Jobs.Status");
  EXPECT_EQ(Number(job->job), UINT64_MAX);
  const auto worker = FindRoute("POST", "/api/v1/workers/00000000000000ff/drain", methods);
  ASSERT_TRUE(worker);
  EXPECT_EQ(worker->worker, "00000000000000ff");
  EXPECT_TRUE(FindRoute("HEAD", "/api/v1/me", methods));
  const auto blob = FindRoute("PUT", "/api/v1/blobs/" + Sha256("a file").Hex(), methods);
  ASSERT_TRUE(blob);
  EXPECT_EQ(blob->blob, Sha256("a file"));
}

TEST(WebRoutes, OtherPathsAreNotFound) {
  std::string methods;
  for (const char* path : {"/api/v1/jobs/0",
                           "/api/v1/jobs/01",
                           "/api/v1/jobs/-1",
                           "/api/v1/jobs/18446744073709551616",
                           "/api/v1/jobs/1/",
                           "/api/v1/jobs/",
                           "/api/v1/jobs//picture",
                           "/api/v1/jobs/1/../2",
                           "/api/v1/jobs/1%2f",
                           "/api/v1",
                           "/api/v2/me",
                           "",
                           "/",
                           "//api/v1/me",
                           "/api/v1/workers/ff/drain",
                           "/api/v1/workers/00000000000000FF/drain",
                           "/api/v1/blobs/ff",
                           "/api/v1/blobs/",
                           "/api/v1/jobs/1/pausee",
                           "/api/v1/jobs/1/picture.exr/x"}) {
    EXPECT_FALSE(FindRoute("GET", path, methods)) << path;
    EXPECT_FALSE(FindRoute("POST", path, methods)) << path;
  }
  EXPECT_EQ(methods, "");
}

TEST(WebRoutes, AWrongMethodNamesTheRightOnes) {
  std::string methods;
  EXPECT_FALSE(FindRoute("GET", "/api/v1/jobs/1/pause", methods));
  EXPECT_EQ(methods, "POST");
  methods.clear();
  EXPECT_FALSE(FindRoute("DELETE", "/api/v1/jobs/1", methods));
  EXPECT_EQ(methods, "GET, HEAD");
  methods.clear();
  EXPECT_FALSE(FindRoute("PUT", "/api/v1/jobs", methods));
  EXPECT_EQ(methods, "GET, HEAD, POST");
  EXPECT_TRUE(FindRoute("POST", "/api/v1/jobs", methods));
  EXPECT_EQ(methods, "");
}

std::set<std::string> WordsOf(std::string_view list) {
  std::set<std::string> words;
  std::string word;
  for (const char c : std::string(list) + " ") {
    if (c != ' ') {
      word += c;
    } else if (!word.empty()) {
      words.insert(std::exchange(word, ""));
    }
  }
  return words;
}

TEST(OpenApi, DescribesEveryRouteAndNothingElse) {
  const PageFile* const file = FindPageFile("/page/openapi.json");
  ASSERT_NE(file, nullptr);
  const json document = json::parse(*file->bytes);
  std::set<std::string> described, handled;
  for (const auto& [path, operations] : document["paths"].items()) {
    for (const auto& [method, operation] : operations.items()) described.insert(method + " " + path);
  }
  for (const WebRoute& route : kWebRoutes) {
    const std::string method = route.method == "GET" ? "get" : route.method == "PUT" ? "put" : "post";
    handled.insert(method + " " + std::string(route.path));
    const json operation = document["paths"][std::string(route.path)][method];
    EXPECT_EQ(operation["x-call"], std::string(route.call)) << route.path;
    std::set<std::string> parameters;
    bool has_proof = false;
    for (const json& parameter : operation.value("parameters", json::array())) {
      if (parameter["in"] == "query") parameters.insert(parameter["name"]);
      has_proof = has_proof || parameter["name"] == "X-Tessera-Proof";
    }
    if (route.body != WebBody::kBytes && operation.contains("requestBody")) {
      const json& schema = operation["requestBody"]["content"]["application/json"]["schema"];
      for (const auto& [name, member] : schema["properties"].items()) parameters.insert(name);
    }
    EXPECT_EQ(parameters, WordsOf(route.parameters)) << route.path;
    EXPECT_EQ(has_proof, method != "get") << route.path;
  }
  EXPECT_EQ(described, handled);
}

TEST(PageFiles, AreServedUnderTheirNamesAlone) {
  EXPECT_TRUE(FindPageFile("/")->is_page);
  EXPECT_EQ(FindPageFile("/page/app.js")->type, "text/javascript; charset=utf-8");
  for (const char* path :
       {"/index.html", "/page/", "/page/index.html", "/page/../page/app.js", "/page/embed.cmake", ""})
    EXPECT_EQ(FindPageFile(path), nullptr) << path;
}

// Data of the farm never becomes markup or script, and nothing is loaded from elsewhere.
TEST(PageFiles, NeitherMakeMarkupOfTextNorLoadFromElsewhere) {
  for (const char* name : {"api.js",
                           "app.js",
                           "chart.js",
                           "color.js",
                           "dom.js",
                           "farm.js",
                           "job.js",
                           "jobs.js",
                           "legend.js",
                           "list.js",
                           "picture_source.js",
                           "picture_stream.js",
                           "strip.js",
                           "viewer.js",
                           "viewer_overlay.js",
                           "viewer_tools.js",
                           "workers.js",
                           "sha256.js",
                           "scene_package.js",
                           "submit.js",
                           "upload.js",
                           "style.css",
                           "job.css",
                           "submit.css"}) {
    const PageFile* const file = FindPageFile(std::string("/page/") + name);
    ASSERT_NE(file, nullptr) << name;
    for (const char* word : {"innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(",
                             "new Function", "https://", "//cdn", "@import", "url("})
      EXPECT_THAT(*file->bytes, testing::Not(testing::HasSubstr(word))) << name;
  }
  EXPECT_THAT(*FindPageFile("/")->bytes,
              testing::Not(testing::ContainsRegex("(<script>| style=| on[a-z]+=|https?://)")));
}

}  // namespace
}  // namespace tessera
