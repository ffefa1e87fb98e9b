// The web pages over TLS: who gets in, and what everybody else sees.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/coordinator/web/encrypted_web_fixture.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kStrangerText = "needs a certificate of the farm";

TEST_F(EncryptedWeb, AStrangerSeesAFormAndNothingAboutTheFarm) {
  const WebClient stranger = Browser();
  const WebAnswer page = stranger.Get("/");
  EXPECT_EQ(page.status(), 303);
  EXPECT_EQ(page.Header("Location"), "/login");
  EXPECT_THAT(page.Body(), IsEmpty());
  const WebAnswer form = stranger.Get("/login");
  EXPECT_EQ(form.status(), 200);
  EXPECT_THAT(form.Body(), AllOf(HasSubstr("<form"), Not(HasSubstr("workers")), Not(HasSubstr("Jobs"))));
  for (const char* path : {"/metrics", "/logout", "/health", "/favicon.ico", "/../etc/passwd", "//",
                           "/api/v1/me", "/api/v1/events", "/page/app.js", "/stream"}) {
    EXPECT_EQ(stranger.Get(path).status(), 401) << path;
    EXPECT_THAT(stranger.Get(path).Body(), HasSubstr(kStrangerText)) << path;
  }
  EXPECT_EQ(stranger.Post("/", "a=b").status(), 401);
  EXPECT_EQ(stranger.Change("/change", "").status(), 401);
  EXPECT_EQ(stranger.Post("/logout", "a=b").status(), 401);
}

TEST_F(EncryptedWeb, AMemberWithACertificateSeesPageAndMetrics) {
  const WebClient member(port(), IdentityOf(Role::kViewer));
  EXPECT_EQ(member.Get("/").status(), 200);
  EXPECT_THAT(member.Get("/").Body(), AllOf(HasSubstr("somebody (viewer)"), Not(HasSubstr("Log out"))));
  EXPECT_THAT(member.Get("/metrics").Body(), HasSubstr("tessera_workers 0"));
  EXPECT_EQ(member.Get("/login").status(), 303);
  EXPECT_EQ(member.Get("/nothing").status(), 404);
  EXPECT_EQ(member.Change("/", member.Get("/proof").Body()).status(), 405);
}

TEST_F(EncryptedWeb, ACertificateOfAnotherFarmEndsTheHandshake) {
  const Authority other = Authority::Make("farm", UnixNow());
  const WebClient stranger(port(), Identity(other, Subject{Role::kOperator, MemberId{1}, {}}.Uri()));
  EXPECT_THAT(stranger.Get("/login").text, IsEmpty());
}

TEST_F(EncryptedWeb, ACertificateWhoseRoleIsNotEnoughIsToldSo) {
  const WebClient worker(port(), IdentityOf(Role::kWorker));
  for (const char* path : {"/", "/metrics"}) {
    EXPECT_EQ(worker.Get(path).status(), 403);
    EXPECT_EQ(worker.Get(path).Body(), "a worker may not see this\n");
  }
}

TEST_F(EncryptedWeb, ATokenOpensASessionOnce) {
  const std::string token = MakeToken("ada <b>");
  WebClient browser = Browser();
  const WebAnswer login = browser.LogIn(token);
  EXPECT_EQ(login.status(), 303) << login.text;
  EXPECT_EQ(login.Header("Location"), "/");
  EXPECT_THAT(browser.Get("/").Body(), AllOf(HasSubstr("ada &lt;b&gt; (user)"), HasSubstr("Log out")));
  EXPECT_EQ(browser.Get("/metrics").status(), 200);
  WebClient other = Browser();
  const WebAnswer again = other.LogIn(token);
  EXPECT_EQ(again.status(), 403);
  EXPECT_THAT(again.Body(), HasSubstr("this farm does not know the token"));
  EXPECT_EQ(other.Get("/metrics").status(), 401);
}

TEST_F(EncryptedWeb, CookiesStayWithTheBrowserTheHostAndTls) {
  WebClient browser = Browser();
  const std::string form = browser.Get("/login").Header("Set-Cookie");
  const std::string session = browser.LogIn(MakeToken()).Header("Set-Cookie");
  for (const std::string& cookie : {form, session}) {
    EXPECT_THAT(cookie, testing::StartsWith("__Host-tessera-"));
    for (const char* flag : {"; Secure", "; HttpOnly", "; SameSite=Strict", "; Path=/;"})
      EXPECT_THAT(cookie, HasSubstr(flag)) << cookie;
    EXPECT_THAT(cookie, Not(HasSubstr("Domain")));
  }
  EXPECT_THAT(session, testing::ContainsRegex("__Host-tessera-session=[0-9a-f]{64};"));
}

TEST_F(EncryptedWeb, EveryAnswerForbidsWhatThePagesDoNotNeed) {
  WebClient browser = Browser();
  const WebAnswer form = browser.Get("/login"), refused = browser.Get("/metrics");
  browser.LogIn(MakeToken());
  for (const WebAnswer& answer : {form, refused, browser.Get("/"), browser.Get("/metrics")}) {
    const std::string policy = answer.Header("Content-Security-Policy");
    EXPECT_THAT(policy, AllOf(HasSubstr("default-src 'none'"), HasSubstr("frame-ancestors 'none'"),
                              HasSubstr("form-action 'self'"), HasSubstr("base-uri 'none'"),
                              Not(HasSubstr("unsafe"))));
    EXPECT_EQ(answer.Header("X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(answer.Header("Referrer-Policy"), "same-origin");
    EXPECT_EQ(answer.Header("Cache-Control"), "no-store");
    EXPECT_THAT(answer.Body(), Not(HasSubstr("style=\"")));
    EXPECT_THAT(answer.Body(), Not(HasSubstr("<script")));
  }
  EXPECT_THAT(form.Header("Content-Security-Policy"), Not(HasSubstr("script-src")));
  EXPECT_THAT(browser.Get("/").Header("Content-Security-Policy"),
              AllOf(HasSubstr("script-src 'self'"), HasSubstr("style-src 'self'"),
                    HasSubstr("require-trusted-types-for 'script'")));
}

TEST_F(EncryptedWeb, AChangeNeedsTheProofOfThatVisitorAndAPageOfThisServer) {
  WebClient browser = Browser(), other = Browser();
  browser.LogIn(MakeToken());
  other.LogIn(MakeToken());
  const std::string proof = browser.Get("/proof").Body();
  for (const std::string& wrong :
       {std::string(), std::string(64, '0'), other.Get("/proof").Body(), proof + "0"})
    EXPECT_EQ(browser.Change("/change", wrong).status(), 403);
  browser.origin = "https://evil.example";
  EXPECT_EQ(browser.Change("/change", proof).status(), 403);
  browser.origin = "null";
  EXPECT_EQ(browser.Change("/change", proof).status(), 403);
  EXPECT_EQ(content().changes, 0);
  browser.origin = "https://localhost";
  EXPECT_EQ(browser.Change("/change", proof).status(), 200);
  const WebClient program(port(), IdentityOf(Role::kUser));
  EXPECT_EQ(program.Change("/change", proof).status(), 403);
  EXPECT_EQ(program.Change("/change", program.Get("/proof").Body()).status(), 200);
  EXPECT_EQ(content().changes, 2);
}

TEST_F(EncryptedWeb, StreamsEndSoonAfterTheirMemberIsRevoked) {
  WebClient browser = Browser();
  browser.LogIn(MakeToken());
  TlsClient client(port());
  ASSERT_TRUE(client.Handshake());
  ASSERT_TRUE(
      client.Send("GET /stream HTTP/1.1\r\nHost: localhost\r\nCookie: " + browser.cookie + "\r\n\r\n"));
  EXPECT_THAT(client.ReadSome(), HasSubstr("200 OK"));
  EXPECT_THAT(client.ReadSome(), testing::StartsWith("x"));
  Revoke();
  while (!client.ReadSome().empty()) {
  }
}

TEST_F(EncryptedWeb, AMemberHasABoundedNumberOfStreamsAndOthersHaveTheirs) {
  WebClient browser = Browser(), other = Browser();
  browser.LogIn(MakeToken("ada"));
  other.LogIn(MakeToken("bob"));
  const auto request = [](const WebClient& from, const char* path) {
    return fmt::format("GET {} HTTP/1.1\r\nHost: localhost\r\nCookie: {}\r\n\r\n", path, from.cookie);
  };
  std::vector<std::unique_ptr<TlsClient>> clients;
  int refused = 0;
  for (int i = 0; i < 70; ++i) {
    clients.push_back(std::make_unique<TlsClient>(port()));
    ASSERT_TRUE(clients.back()->Handshake());
    ASSERT_TRUE(clients.back()->Send(request(browser, "/stream")));
    const std::string answer = clients.back()->ReadSome();
    refused += answer.find(" 503 ") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(refused, 6);
  EXPECT_EQ(other.Get("/metrics").status(), 200);
  TlsClient client(port());
  ASSERT_TRUE(client.Handshake());
  ASSERT_TRUE(client.Send(request(other, "/stream")));
  EXPECT_THAT(client.ReadSome(), HasSubstr(" 200 "));
}

TEST_F(EncryptedWeb, AFormFromAnotherSiteChangesNothing) {
  WebClient browser = Browser();
  const WebAnswer form = browser.Get("/login");
  browser.cookie = form.Cookie();
  const std::string token = MakeToken();
  for (const char* origin : {"https://evil.example", "http://localhost", "https://localhost:1", "null", ""}) {
    browser.origin = origin;
    EXPECT_EQ(browser.Post("/login", "proof=" + form.Proof() + "&token=" + token).status(), 403) << origin;
  }
  browser.origin = "https://localhost";
  for (const std::string& proof : {std::string(), std::string(64, '0'), Browser().Get("/login").Proof()}) {
    const WebAnswer refused = browser.Post("/login", "proof=" + proof + "&token=" + token);
    EXPECT_EQ(refused.status(), 403);
    EXPECT_THAT(refused.Body(), HasSubstr("The form is too old"));
  }
  browser.cookie = "";
  EXPECT_EQ(browser.Post("/login", "proof=" + form.Proof() + "&token=" + token).status(), 403);
  browser.cookie = form.Cookie();
  EXPECT_EQ(browser.Post("/login", "proof=" + form.Proof() + "&token=" + token).status(), 303)
      << "the token has not been used";
}

TEST_F(EncryptedWeb, LoggingOutTakesTheFormOfThatSession) {
  WebClient browser = Browser(), other = Browser();
  browser.LogIn(MakeToken());
  other.LogIn(MakeToken());
  const std::string proof = browser.Get("/").Proof();
  EXPECT_EQ(browser.Get("/logout").status(), 405);
  EXPECT_EQ(browser.Post("/logout", "proof=" + other.Get("/").Proof()).status(), 403);
  EXPECT_EQ(browser.Post("/logout", "").status(), 403);
  browser.origin = "https://evil.example";
  EXPECT_EQ(browser.Post("/logout", "proof=" + proof).status(), 403);
  browser.origin = "https://localhost";
  EXPECT_EQ(browser.Get("/").status(), 200);
  const WebAnswer done = browser.Post("/logout", "proof=" + proof);
  EXPECT_EQ(done.status(), 303);
  EXPECT_THAT(done.Header("Set-Cookie"), HasSubstr("Max-Age=0"));
  EXPECT_EQ(browser.Get("/metrics").status(), 401);
  EXPECT_EQ(other.Get("/metrics").status(), 200);
}

TEST_F(EncryptedWeb, ASessionEndsWhenItsMemberIsRevoked) {
  WebClient browser = Browser();
  browser.LogIn(MakeToken());
  EXPECT_EQ(browser.Get("/metrics").status(), 200);
  Revoke();
  EXPECT_EQ(browser.Get("/metrics").status(), 401);
  EXPECT_EQ(browser.Get("/").Header("Location"), "/login");
}

TEST_F(EncryptedWeb, CookiesThatWereMadeUpOrAreHugeOpenNothing) {
  WebClient browser = Browser();
  for (const std::string& value :
       {std::string(), std::string("x"), std::string(64, '0'), std::string(4000, 'a')}) {
    browser.cookie = "__Host-tessera-session=" + value;
    EXPECT_EQ(browser.Get("/metrics").status(), 401);
  }
  browser.cookie = "__Host-tessera-session=" + std::string(20'000, 'a');
  EXPECT_EQ(browser.Get("/metrics").status(), 431);
}

TEST_F(EncryptedWeb, ATokenInAnAddressIsRefusedAndNotUsed) {
  WebClient browser = Browser();
  const std::string token = MakeToken();
  for (const char* path : {"/login?token=", "/?"}) {
    const WebAnswer refused = browser.Get(path + token);
    EXPECT_EQ(refused.status(), 400);
    EXPECT_THAT(refused.Body(), HasSubstr("Have it revoked"));
    EXPECT_THAT(refused.text, Not(HasSubstr(token)));
  }
  EXPECT_EQ(browser.LogIn(token).status(), 303);
}

TEST_F(EncryptedWeb, OtherWordsThatBeginAsTokensDoMayBeInAnAddress) {
  WebClient browser = Browser();
  ASSERT_EQ(browser.LogIn(MakeToken()).status(), 303);
  for (const char* query : {"search=tessera-night-shift", "search=tessera-", "tessera-1=2"})
    EXPECT_EQ(browser.Get(std::string("/?") + query).status(), 200) << query;
}

TEST_F(EncryptedWeb, LoginsThatFailAreLimitedForEachAddress) {
  WebClient browser = Browser();
  int refused = 0;
  WebAnswer last;
  for (int i = 0; i < 100 && last.status() != 429; ++i, ++refused)
    last = browser.LogIn(JoinToken::Make("farm:1", {}).Text());
  EXPECT_EQ(last.status(), 429);
  EXPECT_LT(refused, 50);
  WebClient elsewhere = Browser("127.0.0.2");
  EXPECT_EQ(elsewhere.LogIn(MakeToken()).status(), 303);
}

TEST_F(EncryptedWeb, WhatIsNoTokenIsRefusedWithTheReason) {
  for (const char* text : {"", "hello", "tessera-", "tessera-AAAA", "%3Cscript%3E"}) {
    const WebAnswer refused = Browser().LogIn(text);
    EXPECT_EQ(refused.status(), 403) << text;
    EXPECT_THAT(refused.Body(), AllOf(HasSubstr("Login failed"), Not(HasSubstr("<script")))) << text;
  }
}

TEST_F(EncryptedWeb, FormsThatAreMalformedOrTooLargeAreRefused) {
  WebClient browser = Browser();
  EXPECT_EQ(browser.Post("/login", "token=%4").status(), 400);
  EXPECT_EQ(browser.Post("/login", "token=1&token=2").status(), 400);
  EXPECT_EQ(browser.Post("/login", std::string(kHttpBodyBytesMax + 1, 'a')).status(), 413);
  EXPECT_EQ(browser
                .Send("POST /login HTTP/1.1\r\nHost: localhost\r\nOrigin: https://localhost\r\n"
                      "Content-Type: text/plain\r\nContent-Length: 1\r\n\r\na")
                .status(),
            403);
  EXPECT_EQ(browser.Send("PUT /login HTTP/1.1\r\nHost: localhost\r\n\r\n").status(), 405);
}

TEST_F(EncryptedWeb, OnlyTheNamesOfTheCertificateAreServed) {
  WebClient browser = Browser();
  for (const char* host :
       {"localhost", "LOCALHOST:7780", "127.0.0.1", "[::1]:7780", "a.farm.example", "named.example"}) {
    browser.host = host;
    EXPECT_EQ(browser.Get("/login").status(), 200) << host;
  }
  for (const char* host :
       {"", "evil.example", "10.1.2.3", "a.b.farm.example", ".farm.example", "localhost.evil.example"}) {
    browser.host = host;
    EXPECT_EQ(browser.Get("/login").status(), 403) << host;
  }
}

TEST_F(EncryptedWeb, ARenewedCertificateIsShownFromTheNextConnectionsOn) {
  const Digest before = Fingerprint();
  EXPECT_EQ(Fingerprint(), before);
  WriteServerCertificate({"renewed.example"});
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (Fingerprint() == before && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_NE(Fingerprint(), before);
  WebClient browser = Browser();
  EXPECT_EQ(browser.Get("/login").status(), 403);
  browser.host = "renewed.example";
  EXPECT_EQ(browser.Get("/login").status(), 200);
}

TEST_F(EncryptedWeb, ADamagedCertificateFileDoesNotReplaceTheOneInUse) {
  const Digest before = Fingerprint();
  EXPECT_TRUE(WritePrivateFile(path(), "damaged"));
  testing::internal::CaptureStdout();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (std::chrono::steady_clock::now() < deadline) {
    EXPECT_EQ(Fingerprint(), before);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("web_certificate_not_reloaded"));
}

TEST_F(EncryptedWeb, OlderVersionsOfTlsAreRefused) {
  EXPECT_FALSE(TlsClient(port(), "", TLS1_2_VERSION).Handshake());
  EXPECT_FALSE(TlsClient(port(), "", TLS1_1_VERSION).Handshake());
  TlsClient client(port());
  ASSERT_TRUE(client.Handshake());
  EXPECT_EQ(SSL_version(client.ssl()), TLS1_3_VERSION);
}

// Each connection proves anew who is there.
TEST_F(EncryptedWeb, SessionsOfTlsAreNotResumed) {
  TlsClient client(port(), IdentityOf(Role::kViewer));
  ASSERT_TRUE(client.Handshake());
  EXPECT_TRUE(client.Send("GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  EXPECT_THAT(client.ReadAll(), HasSubstr("HTTP/1.1 200"));
  EXPECT_EQ(SSL_SESSION_is_resumable(SSL_get0_session(client.ssl())), 0);
}

TEST_F(EncryptedWeb, PlainHttpGetsNoAnswer) {
  const int socket = ConnectTo(port());
  const std::string request = "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n";
  ::send(socket, request.data(), request.size(), MSG_NOSIGNAL);
  EXPECT_THAT(ReadPlain(socket), Not(HasSubstr("HTTP/1.1")));
  ::close(socket);
}

TEST_F(EncryptedWeb, AHandshakeThatDoesNotGoOnIsClosed) {
  const int silent = ConnectTo(port()), slow = ConnectTo(port());
  const std::string start("\x16\x03\x01\x02\x00\x01", 6);
  ::send(slow, start.data(), start.size(), MSG_NOSIGNAL);
  EXPECT_EQ(ReadPlain(silent), "") << "returns when the server closes the connection";
  EXPECT_EQ(ReadPlain(slow), "");
  ::close(silent);
  ::close(slow);
}

TEST_F(EncryptedWeb, ACrowdOfUnfinishedHandshakesKeepsNobodyOut) {
  std::vector<int> crowd;
  for (int i = 0; i < 300; ++i) crowd.push_back(ConnectTo(port(), "127.0.0.2"));
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(Browser().Get("/login").status(), 200);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(4));
  for (const int each : crowd) ::close(each);
}

TEST_F(EncryptedWeb, ALongPageArrivesWhole) {
  const WebClient member(port(), IdentityOf(Role::kViewer));
  const WebAnswer answer = member.Get("/metrics");
  EXPECT_EQ(answer.Body().size(), std::stoul(answer.Header("Content-Length")));
  EXPECT_THAT(member.Send("HEAD / HTTP/1.1\r\nHost: localhost\r\n\r\n").Body(), IsEmpty());
}

}  // namespace
}  // namespace tessera
