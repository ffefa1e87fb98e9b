// The web server: metrics, page, and requests it must not serve.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>

#include "coordinator/http_request.h"
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
  EXPECT_THAT(page, HasSubstr("<td>&lt;b&gt;ada</td>"));
  EXPECT_THAT(page, Not(HasSubstr("<i>\"")));
  EXPECT_THAT(page, HasSubstr("25.0 %"));
  EXPECT_THAT(page, Not(HasSubstr("http://"))) << "loads nothing from elsewhere";
}

TEST(WebServer, ServesThePageAndTheMetricsAndNothingElse) {
  const auto web = WebServer::Start(Loopback(0), {"farm.example"}, [] { return std::optional(SomeView()); });
  ASSERT_TRUE(web) << web.error().message;
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/")->status, 200);
  EXPECT_THAT(client.Get("/")->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
  EXPECT_THAT(client.Get("/metrics")->body, HasSubstr("tessera_workers 1"));
  EXPECT_EQ(client.Get("/../etc/passwd")->status, 404);
  EXPECT_EQ(client.Post("/", "x", "text/plain")->status, 405);
}

TEST(WebServer, AFarmThatDoesNotAnswerIsReportedAsBusy) {
  const auto web = WebServer::Start(Loopback(0), {"farm.example"}, [] { return std::optional<FarmView>(); });
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/metrics")->status, 503);
}

TEST(WebServer, APortInUseIsAnErrorThatNamesIt) {
  const auto web = WebServer::Start(Loopback(0), {"farm.example"}, [] { return std::optional<FarmView>(); });
  const Address taken = (*web)->address();
  const auto second = WebServer::Start(taken, {}, [] { return std::optional<FarmView>(); });
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kFailed);
  EXPECT_THAT(second.error().message, HasSubstr(taken.Text()));
}

TEST(HttpRequest, ReadsWhatThePageNeeds) {
  const auto request =
      ParseHttpRequest("GET /metrics?x=1 HTTP/1.1\r\nAccept: */*\r\nHOST:  Farm.Example:7780\r\n\r\n");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->method, "GET");
  EXPECT_EQ(request->path, "/metrics");
  EXPECT_EQ(request->host, "farm.example");
  EXPECT_EQ(ParseHttpRequest("GET / HTTP/1.1\r\nHost: [::1]:80\r\n\r\n")->host, "[::1]");
  EXPECT_EQ(ParseHttpRequest("GET / HTTP/1.0\r\n\r\n")->host, "");
}

TEST(HttpRequest, RefusesWhatIsMalformed) {
  for (const char* head :
       {"", "\r\n\r\n", "GET\r\n\r\n", "GET /\r\n\r\n", "GET / HTTP/2\r\n\r\n",
        "GET http://a/ HTTP/1.1\r\n\r\n", "GET / HTTP/1.1\r\n", "GET / HTTP/1.1\r\nHost\r\n\r\n",
        "GET / HTTP/1.1\r\n: x\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n"})
    EXPECT_FALSE(ParseHttpRequest(head)) << head;
}

TEST(HttpRequest, OnlyNumbersLocalhostAndNamedHostsAreItsOwn) {
  const std::vector<std::string> names{"Farm.Example"};
  for (const char* host : {"localhost", "127.0.0.1", "10.1.2.3", "[::1]", "farm.example"})
    EXPECT_TRUE(IsOwnHost(host, names)) << host;
  for (const char* host : {"", "evil.example", "localhost.evil.example", "127.0.0.1.evil.example", "[evil]"})
    EXPECT_FALSE(IsOwnHost(host, names)) << host;
}

int Connect(const WebServer& web) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(web.address().port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  return fd;
}

// Everything until the server closes the connection.
std::string ReadAll(int fd) {
  std::string all;
  char bytes[4096];
  for (ssize_t size = 0; (size = ::recv(fd, bytes, sizeof bytes, 0)) > 0;)
    all.append(bytes, static_cast<size_t>(size));
  return all;
}

TEST(WebServer, OtherNamesAreRefusedSoThatForeignPagesCannotReadIt) {
  const auto web = WebServer::Start(Loopback(0), {"farm.example"}, [] { return std::optional(SomeView()); });
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/", {{"Host", "evil.example"}})->status, 403);
  EXPECT_EQ(client.Get("/", {{"Host", "farm.example:80"}})->status, 200);
  EXPECT_EQ(client.Head("/", {{"Host", "localhost"}})->status, 200);
}

TEST(WebServer, HeadsAreBounded) {
  const auto web = WebServer::Start(Loopback(0), {}, [] { return std::optional(SomeView()); });
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
  EXPECT_THAT(ReadAll(fd), HasSubstr("HTTP/1.1 431 "));
  ::close(fd);
}

TEST(WebServer, SlowAndSilentConnectionsDoNotDelayOthers) {
  const auto web = WebServer::Start(Loopback(0), {}, [] { return std::optional(SomeView()); });
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
  const auto web = WebServer::Start(Loopback(0), {}, [] { return std::optional(SomeView()); });
  const int fd = Connect(**web);
  ::send(fd, "GET / HTTP/1.1\r\n", 16, MSG_NOSIGNAL);
  EXPECT_EQ(ReadAll(fd), "") << "returns when the server closes the connection";
  ::close(fd);
}

}  // namespace
}  // namespace tessera
