// The connections of the web pages: HTTP/1.1, over TLS 1.3 or plain.
#pragma once

#include <chrono>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/listener/peer_budget.h"
#include "coordinator/web/http_request.h"
#include "coordinator/web/web_connection.h"
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

// One thread serves a bounded number of connections with a bounded request each, all but streams for a
// bounded time. Whoever connects when all places are taken gets the place of a connection that is still
// waiting for its request: of the network that has the most of these, the oldest. So slow and silent peers
// cannot keep others from the pages. Streams have places of their own, a bounded number for each member, and
// end when their reader takes nothing for some seconds; so have bodies that are taken in pieces, which end
// when their sender is too slow. The farm is never delayed.
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
  static constexpr std::chrono::seconds kLogInterval{10};

  WebServer(Address address, std::optional<WebTls> tls, std::unique_ptr<WebSite> site);
  Result<void> LoadCertificate();
  void ReloadCertificate();
  void Run();
  void Accept(int socket);
  void Admit(int socket);
  void MakeRoom();
  void Serve(WebConnection& connection, bool is_ready);
  void Handshake(WebConnection& connection);
  void TakeRequest(WebConnection& connection);
  void Answer(WebConnection& connection, const HttpRequest& request);
  void Receive(WebConnection& connection, const HttpRequest& request, size_t head_size);
  void Deliver(WebConnection& connection, HttpResponse response);
  bool HasPlaceForStream(const std::string& owner) const;
  bool HasPlaceForUpload(const std::string& owner) const;
  std::function<void()> Notification() const;

  Address address_;
  const std::optional<WebTls> tls_;
  const std::unique_ptr<WebSite> site_;
  std::vector<int> sockets_;
  int stop_event_ = -1;
  // Written to when an answer was made. Shared by whoever makes one, who may be late.
  std::shared_ptr<const int> wake_event_;
  // The others are of the thread.
  std::optional<TlsServer> server_;
  std::string loaded_pem_;  // key and certificate of `server_`
  Clock::time_point reload_due_{};
  PeerBudget handshakes_;
  RareLog failed_{kLogInterval};
  std::list<WebConnection> connections_;  // oldest first
  std::thread thread_;
};

}  // namespace tessera
