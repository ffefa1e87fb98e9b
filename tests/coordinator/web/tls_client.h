// A client of the web pages over TLS that does what a test wants, also what no browser would do.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cctype>
#include <string>

#include "proto/identity/certificate.h"
#include "proto/identity/private_key.h"

namespace tessera {

// A TCP connection to 127.0.0.1, from `source`. Reads wait at most 30 seconds.
inline int ConnectTo(int port, const char* source = "127.0.0.1") {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_addr.s_addr = ::inet_addr(source);
  EXPECT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  const timeval patience{30, 0};
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  name.sin_port = htons(static_cast<uint16_t>(port));
  name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  return socket;
}

// Everything until the server closes the connection.
inline std::string ReadPlain(int socket) {
  std::string all;
  char bytes[4096];
  for (ssize_t size = 0; (size = ::recv(socket, bytes, sizeof bytes, 0)) > 0;)
    all.append(bytes, static_cast<size_t>(size));
  return all;
}

class TlsClient {
 public:
  // `identity_pem` holds the key and certificate to show; empty: none.
  explicit TlsClient(int port, const std::string& identity_pem = "", int version_max = TLS1_3_VERSION,
                     const char* source = "127.0.0.1")
      : socket_(ConnectTo(port, source)), context_(SSL_CTX_new(TLS_client_method())) {
    SSL_CTX_set_max_proto_version(context_, version_max);
    if (!identity_pem.empty()) {
      SSL_CTX_use_certificate(context_, Certificate::FromPem(identity_pem, "test")->get());
      SSL_CTX_use_PrivateKey(context_, PrivateKey::FromPem(identity_pem, "test")->get());
    }
    ssl_ = SSL_new(context_);
    SSL_set_fd(ssl_, socket_);
  }
  ~TlsClient() {
    SSL_free(ssl_);
    SSL_CTX_free(context_);
    ::close(socket_);
  }
  TlsClient(const TlsClient&) = delete;
  TlsClient& operator=(const TlsClient&) = delete;

  // Returns whether this end of the handshake succeeds. If the server refuses the certificate of the client,
  // only the next read fails.
  bool Handshake() { return SSL_connect(ssl_) == 1; }
  Certificate ServerCertificate() const { return Certificate(SSL_get1_peer_certificate(ssl_)); }
  bool Send(const std::string& bytes) {
    return SSL_write(ssl_, bytes.data(), static_cast<int>(bytes.size())) == static_cast<int>(bytes.size());
  }
  // At most `size` bytes, as they come; empty at the end.
  std::string ReadSome(size_t size = 4096) {
    std::string some(size, '\0');
    const int received = SSL_read(ssl_, some.data(), static_cast<int>(size));
    some.resize(received > 0 ? static_cast<size_t>(received) : 0);
    return some;
  }
  std::string ReadAll() {
    std::string all;
    char bytes[4096];
    for (int size = 0; (size = SSL_read(ssl_, bytes, sizeof bytes)) > 0;)
      all.append(bytes, static_cast<size_t>(size));
    return all;
  }
  SSL* ssl() { return ssl_; }
  int socket() const { return socket_; }

 private:
  int socket_;
  SSL_CTX* context_;
  SSL* ssl_;
};

// An HTTP answer as text; empty if there was none.
struct WebAnswer {
  std::string text;

  int status() const { return text.size() > 12 ? std::stoi(text.substr(9, 3)) : 0; }
  std::string Header(const std::string& name) const {
    const size_t at = text.find("\r\n" + name + ": ");
    if (at == std::string::npos) return "";
    const size_t start = at + name.size() + 4;
    return text.substr(start, text.find("\r\n", start) - start);
  }
  std::string Body() const { return text.substr(std::min(text.size(), text.find("\r\n\r\n") + 4)); }
  // NAME=VALUE of the cookie that the answer sets.
  std::string Cookie() const {
    const std::string cookie = Header("Set-Cookie");
    return cookie.substr(0, cookie.find(';'));
  }
  // The value of a member of an answer in JSON, a text.
  std::string Member(const std::string& name) const {
    const std::string before = "\"" + name + "\":\"";
    const size_t at = text.find(before);
    if (at == std::string::npos) return "";
    const size_t start = at + before.size();
    return text.substr(start, text.find('"', start) - start);
  }
  // The hidden field of the form in the page.
  std::string Proof() const {
    const std::string before = "name=\"proof\" value=\"";
    const size_t at = text.find(before);
    return at == std::string::npos ? "" : text.substr(at + before.size(), 64);
  }
};

// A browser, or a program with a certificate.
class WebClient {
 public:
  explicit WebClient(int port, std::string identity_pem = "", const char* source = "127.0.0.1")
      : port_(port), identity_pem_(std::move(identity_pem)), source_(source) {}

  std::string host = "localhost";
  std::string cookie;  // sent with each request
  std::string origin = "https://localhost";

  WebAnswer Send(const std::string& request) const {
    TlsClient client(port_, identity_pem_, TLS1_3_VERSION, source_);
    if (!client.Handshake() || !client.Send(request)) return {};
    return {client.ReadAll()};
  }
  WebAnswer Get(const std::string& target) const { return Send("GET " + target + Headers() + "\r\n"); }
  WebAnswer Post(const std::string& path, const std::string& form) const {
    return Send(
        "POST " + path + Headers() + "Content-Type: application/x-www-form-urlencoded\r\nContent-Length: " +
        std::to_string(form.size()) + (origin.empty() ? "" : "\r\nOrigin: " + origin) + "\r\n\r\n" + form);
  }
  // A change, as the scripts of the page ask for it.
  WebAnswer Change(const std::string& path, const std::string& proof, const std::string& json = "{}") const {
    return Send("POST " + path + Headers() + "Content-Type: application/json\r\nContent-Length: " +
                std::to_string(json.size()) + (origin.empty() ? "" : "\r\nOrigin: " + origin) +
                (proof.empty() ? "" : "\r\nX-Tessera-Proof: " + proof) + "\r\n\r\n" + json);
  }
  // As a person does it. Keeps the cookie of the session if that succeeds.
  WebAnswer LogIn(const std::string& token) {
    const WebAnswer form = Get("/login");
    cookie = form.Cookie();
    WebAnswer answer = Post("/login", "proof=" + form.Proof() + "&token=" + token);
    cookie = answer.Cookie();
    return answer;
  }

 private:
  std::string Headers() const {
    return " HTTP/1.1\r\nHost: " + host + "\r\n" + (cookie.empty() ? "" : "Cookie: " + cookie + "\r\n");
  }
  int port_;
  std::string identity_pem_;
  const char* source_;
};

}  // namespace tessera
