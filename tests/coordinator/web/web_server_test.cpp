// The web server: metrics, page, and requests it must not serve.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>

#include "coordinator/web/http_request.h"
#include "coordinator/web/metrics_text.h"
#include "coordinator/web/status_page.h"
#include "coordinator/web/web_server.h"
#include "tests/coordinator/web/tls_client.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

FarmView SomeView() {
  FarmView view;
  JobStatus job;
  job.job = JobId{3};
  job.name = "<script>alert(\"1\")</script>";
  job.owner.name = "<b>ada";
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

// Without encryption and logins.
Result<std::unique_ptr<WebServer>> StartPlain(const Address& address, std::vector<std::string> names,
                                              WebSite::Look look) {
  return WebServer::Start(address, {},
                          std::make_unique<WebSite>(std::move(names), std::move(look), std::nullopt));
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
  const std::string page = StatusPage(StatusContent(SomeView()), {});
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;alert(&quot;1&quot;)"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, HasSubstr("<td>&lt;b&gt;ada</td>"));
  EXPECT_THAT(page, Not(HasSubstr("<i>\"")));
  EXPECT_THAT(page, HasSubstr("25.0 %"));
  EXPECT_THAT(page, Not(HasSubstr("http://"))) << "loads nothing from elsewhere";
}

TEST(WebServer, ServesThePageAndTheMetricsAndNothingElse) {
  const auto web = StartPlain(Loopback(0), {"farm.example"}, [] { return std::optional(SomeView()); });
  ASSERT_TRUE(web) << web.error().message;
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/")->status, 200);
  EXPECT_THAT(client.Get("/")->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
  EXPECT_THAT(client.Get("/metrics")->body, HasSubstr("tessera_workers 1"));
  EXPECT_EQ(client.Get("/../etc/passwd")->status, 404);
  EXPECT_EQ(client.Post("/", "x", "text/plain")->status, 405);
}

TEST(WebServer, AFarmThatDoesNotAnswerIsReportedAsBusy) {
  const auto web = StartPlain(Loopback(0), {"farm.example"}, [] { return std::optional<FarmView>(); });
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/metrics")->status, 503);
}

TEST(WebServer, APortInUseIsAnErrorThatNamesIt) {
  const auto web = StartPlain(Loopback(0), {"farm.example"}, [] { return std::optional<FarmView>(); });
  const Address taken = (*web)->address();
  const auto second = StartPlain(taken, {}, [] { return std::optional<FarmView>(); });
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kFailed);
  EXPECT_THAT(second.error().message, HasSubstr(taken.Text()));
}

int Connect(const WebServer& web) {
  return ConnectTo(web.address().port);
}

TEST(WebServer, OtherNamesAreRefusedSoThatForeignPagesCannotReadIt) {
  const auto web = StartPlain(Loopback(0), {"farm.example"}, [] { return std::optional(SomeView()); });
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/", {{"Host", "evil.example"}})->status, 403);
  EXPECT_EQ(client.Get("/", {{"Host", "farm.example:80"}})->status, 200);
  EXPECT_EQ(client.Head("/", {{"Host", "localhost"}})->status, 200);
}

TEST(WebServer, HeadsAreBounded) {
  const auto web = StartPlain(Loopback(0), {}, [] { return std::optional(SomeView()); });
  for (const std::string& start : {std::string("GET /"), std::string("GET / HTTP/1.1\r\nA: ")}) {
    const int fd = Connect(**web);
    const std::string piece(1 << 16, 'x');
    ::send(fd, start.data(), start.size(), MSG_NOSIGNAL);
    size_t sent = 0;
    while (sent < (size_t{64} << 20)) {
      const ssize_t size = ::send(fd, piece.data(), piece.size(), MSG_NOSIGNAL);
      if (size <= 0) break;
      sent += static_cast<size_t>(size);
    }
    // It stops reading after a second.
    EXPECT_LT(sent, size_t{64} << 20);
    ::close(fd);
  }
  const int fd = Connect(**web);
  const std::string head = "GET / HTTP/1.1\r\nA: " + std::string(kHttpHeadBytesMax, 'x');
  ::send(fd, head.data(), head.size(), MSG_NOSIGNAL);
  EXPECT_THAT(ReadPlain(fd), HasSubstr("HTTP/1.1 431 "));
  ::close(fd);
}

TEST(WebServer, SlowAndSilentConnectionsDoNotDelayOthers) {
  const auto web = StartPlain(Loopback(0), {}, [] { return std::optional(SomeView()); });
  std::vector<int> slow;
  for (int i = 0; i < 200; ++i) {
    slow.push_back(Connect(**web));
    ::send(slow.back(), "G", 1, MSG_NOSIGNAL);
  }
  httplib::Client client("127.0.0.1", (*web)->address().port);
  client.set_read_timeout(60);
  const auto start = std::chrono::steady_clock::now();
  const auto answer = client.Get("/metrics");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3));
  for (const int fd : slow) ::close(fd);
}

TEST(WebServer, AConnectionThatNeverCompletesItsRequestIsClosed) {
  const auto web = StartPlain(Loopback(0), {}, [] { return std::optional(SomeView()); });
  const int fd = Connect(**web);
  ::send(fd, "GET / HTTP/1.1\r\n", 16, MSG_NOSIGNAL);
  EXPECT_EQ(ReadPlain(fd), "") << "returns when the server closes the connection";
  ::close(fd);
}

}  // namespace
}  // namespace tessera
