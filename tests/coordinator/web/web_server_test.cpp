// The web server: metrics, page, and requests it must not serve.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>

#include "coordinator/web/http_request.h"
#include "coordinator/web/metrics_text.h"
#include "coordinator/web/web_server.h"
#include "tests/coordinator/web/some_content.h"
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
                                              std::shared_ptr<WebContent> content) {
  return WebServer::Start(address, {},
                          std::make_unique<WebSite>(std::move(names), std::move(content), std::nullopt));
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

TEST(WebServer, ServesThePageAndTheMetricsAndNothingElse) {
  const auto web = StartPlain(Loopback(0), {"farm.example"}, std::make_shared<SomeContent>());
  ASSERT_TRUE(web) << web.error().message;
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/")->status, 200);
  EXPECT_THAT(client.Get("/")->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
  EXPECT_THAT(client.Get("/metrics")->body, HasSubstr("tessera_workers 0"));
  EXPECT_EQ(client.Get("/../etc/passwd")->status, 404);
  const httplib::Headers proof{{"X-Tessera-Proof", client.Get("/proof")->body}};
  EXPECT_EQ(client.Post("/", proof, "x", "text/plain")->status, 405);
}

TEST(WebServer, APortInUseIsAnErrorThatNamesIt) {
  const auto web = StartPlain(Loopback(0), {"farm.example"}, std::make_shared<SomeContent>());
  const Address taken = (*web)->address();
  const auto second = StartPlain(taken, {}, std::make_shared<SomeContent>());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kFailed);
  EXPECT_THAT(second.error().message, HasSubstr(taken.Text()));
}

int Connect(const WebServer& web) {
  return ConnectTo(web.address().port);
}

TEST(WebServer, OtherNamesAreRefusedSoThatForeignPagesCannotReadIt) {
  const auto web = StartPlain(Loopback(0), {"farm.example"}, std::make_shared<SomeContent>());
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/", {{"Host", "evil.example"}})->status, 403);
  EXPECT_EQ(client.Get("/", {{"Host", "farm.example:80"}})->status, 200);
  EXPECT_EQ(client.Head("/", {{"Host", "localhost"}})->status, 200);
}

TEST(WebServer, HeadsAreBounded) {
  const auto web = StartPlain(Loopback(0), {}, std::make_shared<SomeContent>());
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
  const auto web = StartPlain(Loopback(0), {}, std::make_shared<SomeContent>());
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

TEST(WebServer, AnAnswerOfAnotherThreadIsSentWhenItIsThere) {
  const auto web = StartPlain(Loopback(0), {}, std::make_shared<SomeContent>());
  httplib::Client client("127.0.0.1", (*web)->address().port);
  client.set_read_timeout(60);
  for (int i = 0; i < 20; ++i) {
    const auto answer = client.Get("/later");
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->body, "later");
  }
  EXPECT_EQ(client.Head("/later")->body, "");
}

TEST(WebServer, WhoeverGoesWhileAnAnswerIsMadeLeavesNothing) {
  const auto web = StartPlain(Loopback(0), {}, std::make_shared<SomeContent>());
  for (int i = 0; i < 100; ++i) {
    const int fd = Connect(**web);
    const std::string request = "GET /never HTTP/1.1\r\nHost: localhost\r\n\r\n";
    ::send(fd, request.data(), request.size(), MSG_NOSIGNAL);
    ::close(fd);
  }
  httplib::Client client("127.0.0.1", (*web)->address().port);
  client.set_read_timeout(60);
  EXPECT_EQ(client.Get("/metrics")->status, 200);
}

TEST(WebServer, AReaderThatTakesNothingOfAStreamIsDropped) {
  const auto content = std::make_shared<SomeContent>();
  const auto web = StartPlain(Loopback(0), {}, content);
  const int fd = Connect(**web);
  const std::string request = "GET /flood HTTP/1.1\r\nHost: localhost\r\n\r\n";
  ::send(fd, request.data(), request.size(), MSG_NOSIGNAL);
  const auto wait = [&](int wanted) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (content->open_streams != wanted && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return content->open_streams == wanted;
  };
  EXPECT_TRUE(wait(1));
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_EQ(client.Get("/metrics")->status, 200) << "others are served beside it";
  EXPECT_TRUE(wait(0));
  ::close(fd);
}

TEST(WebServer, ProgramsOfTheUserWhoRunsItAreKnown) {
  const auto web = StartPlain(Loopback(0), {}, std::make_shared<SomeContent>());
  httplib::Client client("127.0.0.1", (*web)->address().port);
  EXPECT_THAT(client.Get("/")->body, HasSubstr("local (operator)"));
}

TEST(WebServer, AConnectionThatNeverCompletesItsRequestIsClosed) {
  const auto web = StartPlain(Loopback(0), {}, std::make_shared<SomeContent>());
  const int fd = Connect(**web);
  ::send(fd, "GET / HTTP/1.1\r\n", 16, MSG_NOSIGNAL);
  EXPECT_EQ(ReadPlain(fd), "") << "returns when the server closes the connection";
  ::close(fd);
}

}  // namespace
}  // namespace tessera
