// The connections of the web pages: HTTP/1.1, over TLS 1.3 or plain.
#pragma once

#include <chrono>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/listener/peer_budget.h"
#include "coordinator/web/http_request.h"
#include "coordinator/web/web_site.h"
#include "proto/identity/tls_server.h"
#include "proto/shell/rare_log.h"
#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace tessera {

// Of encrypted connections.
struct WebTls {
  // Read again when they change. Both may be one file.
  std::string key_path, certificate_path;
  std::vector<Certificate> authorities;  // of client certificates
  TlsServer::CheckClient check;
  std::chrono::milliseconds reload_interval{30'000};  // between looks at the files
};

// One thread serves a bounded number of connections, each for a bounded time and with a bounded request.
// Whoever connects when all places are taken gets the place of a connection that is still waiting for its
// request: of the network that has the most of these, the oldest. So slow and silent peers cannot keep others
// from the pages. The farm is never delayed.
class WebServer {
 public:
  // Without `tls`, connections are plain. An error that names the address if it cannot be listened on, or
  // what is wrong with the certificate.
  static Result<std::unique_ptr<WebServer>> Start(const Address& address, std::optional<WebTls> tls,
                                                  std::unique_ptr<WebSite> site);
  ~WebServer();
  // Takes no new connections and ends the thread.
  void Stop();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  // With the port that was chosen for port 0.
  const Address& address() const { return address_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Connection;
  static constexpr std::chrono::seconds kLogInterval{10};

  WebServer(Address address, std::optional<WebTls> tls, std::unique_ptr<WebSite> site);
  Result<void> LoadCertificate();
  void ReloadCertificate();
  void Run();
  void Accept(int socket);
  void Admit(int socket);
  void MakeRoom();
  void Serve(Connection& connection);
  void Handshake(Connection& connection);
  void Read(Connection& connection);
  void TakeRequest(Connection& connection);
  void Answer(Connection& connection, const HttpRequest& request);

  Address address_;
  const std::optional<WebTls> tls_;
  const std::unique_ptr<WebSite> site_;
  std::vector<int> sockets_;
  int stop_event_ = -1;
  // The others are of the thread.
  std::optional<TlsServer> server_;
  std::string loaded_pem_;  // key and certificate of `server_`
  Clock::time_point reload_due_{};
  PeerBudget handshakes_;
  RareLog failed_{kLogInterval};
  std::list<Connection> connections_;  // oldest first
  std::thread thread_;
};

}  // namespace tessera
