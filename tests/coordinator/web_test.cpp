// The web server: metrics, page, and requests it must not serve.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>

#include "coordinator/metrics_text.h"
#include "coordinator/status_page.h"
#include "coordinator/web_server.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

FarmView SomeView() {
  FarmView view;
  JobStatus job;
  job.job = JobId{3};
  job.name = "<script>alert(\"1\")</script>";
  job.state = JobState::kRunning;
  job.samples_done = 1;
  job.samples_total = 4;
  view.jobs = {job};
  WorkerStatus worker;
  worker.worker = WorkerId{10};
  worker.name = "a\"b\n<i>";
  worker.slots = 2;
  worker.utilisation = 0.5;
  view.workers = {worker};
  view.counters.units_duplicate = 7;
  view.counters.journal_s = 1.5;
  view.traffic.blobs_in = 99;
  view.intake = {12, 5};
  return view;
}

Address Loopback(int port) {
  return *ParseAddress("127.0.0.1:" + std::to_string(port), "test");
}

TEST(MetricsText, ListsEveryCounterWithItsValue) {
  const std::string text = MetricsText(SomeView());
  EXPECT_THAT(text, HasSubstr("# TYPE tessera_results_total counter\n"));
  EXPECT_THAT(text, HasSubstr("tessera_results_total{verdict=\"duplicate\"} 7\n"));
  EXPECT_THAT(text, HasSubstr("tessera_journal_sync_seconds_total 1.5\n"));
  EXPECT_THAT(text, HasSubstr("tessera_jobs{state=\"running\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("tessera_bytes_total{direction=\"in\",what=\"blobs\"} 99\n"));
  EXPECT_THAT(text, HasSubstr("tessera_intake_bytes 12\n"));
  EXPECT_THAT(text, HasSubstr("tessera_intake_waiting 5\n"));
  EXPECT_THAT(text,
              HasSubstr("tessera_worker_utilisation{worker=\"000000000000000a\",name=\"a\\\"b\\n<i>\"} 0.5"));
}

TEST(StatusPage, ShowsJobsAndWorkersAndEscapesTheirNames) {
  const std::string page = StatusPage(SomeView());
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;alert(&quot;1&quot;)"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("<i>\"")));
  EXPECT_THAT(page, HasSubstr("25.0 %"));
  EXPECT_THAT(page, Not(HasSubstr("http://"))) << "loads nothing from elsewhere";
}

TEST(WebServer, ServesThePageAndTheMetricsAndNothingElse) {
  const auto web = WebServer::Start(Loopback(0), [] { return std::optional(SomeView()); });
  ASSERT_TRUE(web) << web.error().message;
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/")->status, 200);
  EXPECT_THAT(client.Get("/")->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
  EXPECT_THAT(client.Get("/metrics")->body, HasSubstr("tessera_workers 1"));
  EXPECT_EQ(client.Get("/../etc/passwd")->status, 404);
  EXPECT_EQ(client.Post("/", "x", "text/plain")->status, 404);
}

TEST(WebServer, AFarmThatDoesNotAnswerIsReportedAsBusy) {
  const auto web = WebServer::Start(Loopback(0), [] { return std::optional<FarmView>(); });
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/metrics")->status, 503);
}

TEST(WebServer, APortInUseIsAnErrorThatNamesIt) {
  const auto web = WebServer::Start(Loopback(0), [] { return std::optional<FarmView>(); });
  const Address taken = (*web)->address();
  const auto second = WebServer::Start(taken, [] { return std::optional<FarmView>(); });
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kFailed);
  EXPECT_THAT(second.error().message, HasSubstr(taken.Text()));
}

TEST(WebServer, SilentConnectionsDelayOthersOnlyBriefly) {
  const auto web = WebServer::Start(Loopback(0), [] { return std::optional(SomeView()); });
  std::vector<int> silent;
  for (int i = 0; i < 6; ++i) {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>((*web)->address().port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ASSERT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    silent.push_back(fd);
  }
  httplib::Client client("127.0.0.1", (*web)->address().port);
  client.set_read_timeout(60);
  const auto answer = client.Get("/metrics");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  for (const int fd : silent) ::close(fd);
}

}  // namespace
}  // namespace tessera
