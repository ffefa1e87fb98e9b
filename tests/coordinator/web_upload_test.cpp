// Files that the web interface takes.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "coordinator/web/http_request.h"
#include "coordinator/web/http_response.h"
#include "proto/blobs/blob_store.h"
#include "tests/coordinator/no_file_grows.h"
#include "tests/coordinator/web/tls_client.h"
#include "tests/coordinator/web_services_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class WebUploads : public WebServices {
 protected:
  static std::string PathOf(const std::string& bytes) { return "/api/v1/blobs/" + Sha256(bytes).Hex(); }
  httplib::Result Put(const std::string& path, const std::string& bytes) {
    return client->Put(path, {{"X-Tessera-Proof", proof}}, bytes, "application/octet-stream");
  }
  int StatusOfPut(const std::string& path, const std::string& bytes) {
    const auto answer = Put(path, bytes);
    return answer ? answer->status : 0;
  }
  json Missing(const json& digests) {
    const auto answer = Post("blobs/missing", {{"digests", digests}});
    EXPECT_EQ(answer->status, 200) << answer->body;
    return json::parse(answer->body, nullptr, false)["missing"];
  }
  json MissingOf(const std::string& bytes) { return Missing({Sha256(bytes).Hex()}); }
  // Sends the head of an upload and the first bytes of its body, and returns the connection.
  int Begin(const std::string& path, uint64_t size, const std::string& bytes) {
    const int fd = ConnectTo(port());
    const std::string request =
        fmt::format("PUT {} HTTP/1.1\r\nHost: localhost\r\nX-Tessera-Proof: {}\r\nContent-Length: {}\r\n\r\n",
                    path, proof, size) +
        bytes;
    EXPECT_EQ(::send(fd, request.data(), request.size(), MSG_NOSIGNAL), static_cast<ssize_t>(request.size()));
    return fd;
  }
};

TEST_F(WebUploads, FilesOfAnySizeArriveAndAreNotMissingAnyMore) {
  for (const size_t size : {size_t{0}, size_t{1}, kHttpBodyBytesMax, kHttpBodyBytesMax + 1, kBodyPieceBytes,
                            kBodyPieceBytes + 1, size_t{3'000'001}}) {
    std::string bytes(size, '\0');
    for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 7 + i / 251);
    ASSERT_EQ(MissingOf(bytes).size(), 1u) << size;
    const auto answer = Put(PathOf(bytes), bytes);
    ASSERT_TRUE(answer) << size;
    EXPECT_EQ(answer->status, 200) << answer->body;
    EXPECT_EQ(MissingOf(bytes).size(), 0u) << size;
    EXPECT_EQ(*coordinator->blobs().Read(Sha256(bytes), size), bytes);
  }
  EXPECT_EQ(StatusOfPut(PathOf("x"), "x"), 200);
  EXPECT_EQ(StatusOfPut(PathOf("x"), "x"), 200) << "a copy is welcome";
}

TEST_F(WebUploads, BytesOfAnotherDigestAreNotKept) {
  const std::string bytes(500'000, 'x'), other(500'000, 'y');
  const auto answer = Put(PathOf(bytes), other);
  EXPECT_EQ(answer->status, 400);
  EXPECT_THAT(answer->body, HasSubstr("SHA-256 mismatch"));
  EXPECT_EQ(MissingOf(bytes).size(), 1u);
  EXPECT_EQ(MissingOf(other).size(), 1u);
}

TEST_F(WebUploads, OneThatWasCutShortIsResumedWhereItStopped) {
  const std::string bytes(3'000'000, 'x');
  ::close(Begin(PathOf(bytes), bytes.size(), bytes.substr(0, 2'000'000)));
  EXPECT_TRUE(ComesTrue([&] { return MissingOf(bytes)[0]["held"] > 1'000'000; }));
  EXPECT_EQ(StatusOfPut(PathOf(bytes) + "?offset=2500000", bytes.substr(2'500'000)), 503)
      << "fewer bytes have arrived";
  // The connection that was cut may still store its last piece.
  EXPECT_TRUE(ComesTrue([&] {
    const uint64_t held = MissingOf(bytes)[0]["held"];
    return StatusOfPut(PathOf(bytes) + fmt::format("?offset={}", held), bytes.substr(held)) == 200;
  }));
  EXPECT_EQ(MissingOf(bytes).size(), 0u);
}

TEST_F(WebUploads, OnAFullDiskTheReasonIsGivenAndOthersGoOn) {
  const std::string bytes(500'000, 'x');
  {
    const NoFileGrows full;
    const int fd = Begin(PathOf(bytes), bytes.size(), bytes.substr(0, 200'000));
    const std::string refused = ReadPlain(fd);
    EXPECT_THAT(refused, HasSubstr("HTTP/1.1 507 "));
    EXPECT_THAT(refused, HasSubstr("{\"error\":"));
    ::close(fd);
    EXPECT_EQ(client->Get("/api/v1/me")->status, 200);
  }
  EXPECT_EQ(StatusOfPut(PathOf(bytes), bytes), 200);
}

TEST_F(WebUploads, APersonHasANumberOfPlacesAndOtherRequestsGoOn) {
  const std::string bytes(5'000, 'x');
  std::vector<int> open;
  for (int i = 0; i < 4; ++i)
    open.push_back(Begin("/api/v1/blobs/" + Sha256(fmt::format("{}", i)).Hex(), 9999, "a"));
  EXPECT_TRUE(ComesTrue([&] { return StatusOfPut(PathOf(bytes), bytes) == 503; }));
  EXPECT_EQ(client->Get("/api/v1/me")->status, 200);
  ::close(open.back());
  EXPECT_TRUE(ComesTrue([&] { return StatusOfPut(PathOf(bytes), bytes) == 200; }));
  for (size_t i = 0; i < 3; ++i) ::close(open[i]);
}

TEST_F(WebUploads, WhatIsNotAllowedIsRefusedBeforeItIsRead) {
  const std::string path = PathOf("a file");
  const auto answer_to = [&](const std::string& head) {
    const int fd = ConnectTo(port());
    const std::string request = head + "\r\nHost: localhost\r\n\r\n";
    ::send(fd, request.data(), request.size(), MSG_NOSIGNAL);
    std::string answer = ReadPlain(fd);
    ::close(fd);
    return answer;
  };
  const std::string with_proof = "\r\nX-Tessera-Proof: " + proof;
  EXPECT_THAT(answer_to("PUT " + path + " HTTP/1.1\r\nContent-Length: 100000"), HasSubstr(" 403 "));
  EXPECT_THAT(answer_to("PUT " + path + " HTTP/1.1\r\nOrigin: http://evil.example\r\nContent-Length: 100000" +
                        with_proof),
              HasSubstr(" 403 "));
  EXPECT_THAT(answer_to("PUT " + path + " HTTP/1.1\r\nContent-Length: 17179869185" + with_proof),
              HasSubstr(" 400 "));
  EXPECT_THAT(
      answer_to("PUT " + path + "?offset=18446744073709551615 HTTP/1.1\r\nContent-Length: 5000" + with_proof),
      HasSubstr(" 400 "));
  EXPECT_THAT(answer_to("PUT " + path + " HTTP/1.1\r\nTransfer-Encoding: chunked" + with_proof),
              HasSubstr(" 400 "));
  EXPECT_THAT(answer_to("POST /api/v1/blobs/missing HTTP/1.1\r\nContent-Type: application/json\r\n"
                        "Content-Length: 200000" +
                        with_proof),
              HasSubstr(" 413 "));
  EXPECT_THAT(answer_to("POST /api/v1/jobs/1/pause HTTP/1.1\r\nContent-Length: 5000" + with_proof),
              HasSubstr(" 413 "));
  EXPECT_THAT(answer_to("PUT /api/v1/blobs/" + std::string(64, 'A') + " HTTP/1.1\r\nContent-Length: 5000" +
                        with_proof),
              HasSubstr(" 413 "));
}

TEST_F(WebUploads, AListOfDigestsIsBoundedAndChecked) {
  const auto status = [&](const std::string& body) {
    return client->Post("/api/v1/blobs/missing", {{"X-Tessera-Proof", proof}}, body, "application/json")
        ->status;
  };
  const std::string digest = Sha256("a file").Hex();
  EXPECT_EQ(status("{}"), 400);
  EXPECT_EQ(status(R"({"digests": 5})"), 400);
  EXPECT_EQ(status(R"({"digests": [5]})"), 400);
  EXPECT_EQ(status(R"({"digests": ["ff"]})"), 400);
  EXPECT_EQ(status(R"({"digests": [], "more": 1})"), 400);
  EXPECT_EQ(status(std::string(100'000, '[')), 400);
  EXPECT_EQ(status(json{{"digests", std::vector<std::string>(1001, digest)}}.dump()), 400);
  EXPECT_EQ(Missing(std::vector<std::string>(1000, digest)).size(), 1u);
}

TEST_F(WebUploads, AnUploadIsEnteredInTheAuditLog) {
  const std::string bytes(500'000, 'x');
  testing::internal::CaptureStdout();
  EXPECT_EQ(StatusOfPut(PathOf(bytes), bytes), 200);
  EXPECT_EQ(StatusOfPut(PathOf("other"), bytes), 400);
  const std::string log = testing::internal::GetCapturedStdout();
  EXPECT_THAT(log, HasSubstr(fmt::format("file={} bytes=500000 result=done", Sha256(bytes).Hex())));
  EXPECT_THAT(log, HasSubstr(fmt::format("file={} bytes=500000 result=failed", Sha256("other").Hex())));
}

TEST_F(WebUploads, ASenderThatStopsLosesItsPlace) {
  const int fd = Begin(PathOf("a file"), 100'000, "some bytes");
  EXPECT_EQ(ReadPlain(fd), "") << "returns when the server closes the connection";
  ::close(fd);
}

}  // namespace
}  // namespace tessera
