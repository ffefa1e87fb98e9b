#include "coordinator/web/http_request.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

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

TEST(HttpRequest, ReadsWhatFormsNeed) {
  const auto request = ParseHttpRequest(
      "POST /login HTTP/1.1\r\nHost: Farm:443\r\nOrigin: HTTPS://farm:443\r\nCookie: a=B; c=d\r\n"
      "Content-Type: application/x-www-form-urlencoded; charset=utf-8\r\nContent-Length: 12\r\n\r\n");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->authority, "farm:443");
  EXPECT_EQ(request->origin, "https://farm:443");
  EXPECT_EQ(request->cookies, "a=B; c=d");
  EXPECT_TRUE(request->is_form);
  EXPECT_EQ(request->body_size, 12u);
  EXPECT_EQ(ParseHttpRequest("GET /a?b?c HTTP/1.1\r\n\r\n")->query, "b?c");
}

TEST(HttpRequest, RefusesBodiesOfUnknownSizeAndHeadersThatContradictEachOther) {
  for (const char* headers :
       {"Content-Length: -1", "Content-Length: 1x", "Content-Length:", "Content-Length: 99999999999999999999",
        "Content-Length: 0\r\nContent-Length: 5", "Transfer-Encoding: chunked", "Cookie: a=1\r\nCookie: b=2",
        "Origin: https://a\r\nOrigin: https://b", "Host:\r\nHost: a"}) {
    EXPECT_FALSE(ParseHttpRequest("POST / HTTP/1.1\r\n" + std::string(headers) + "\r\n\r\n")) << headers;
  }
}

}  // namespace
}  // namespace tessera
