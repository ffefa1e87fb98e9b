#include "coordinator/web/web_server.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>

#include "coordinator/listener/listen_sockets.h"
#include "coordinator/web/peer_user.h"
#include "proto/identity/private_file.h"
#include "proto/identity/private_key.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;

constexpr size_t kWebConnectionsMax = 64;  // some browsers and monitoring systems
// Some 60 people who watch a job each, by two streams. Each takes a descriptor of those that are reserved
// beside members' connections, and some 60 KB with TLS.
constexpr ptrdiff_t kStreamsMax = 128;
constexpr ptrdiff_t kStreamsOfOwnerMax = 64;
// Bodies that are taken in pieces. A browser sends a few files at a time, and one sender fills most networks.
constexpr ptrdiff_t kUploadsMax = 16;
constexpr ptrdiff_t kUploadsOfOwnerMax = 4;
constexpr milliseconds kPollInterval{500};
constexpr milliseconds kStreamInterval{100};  // between looks at what streams have to send
constexpr milliseconds kAcceptPause{250};     // while there is no descriptor or memory for a connection
// A handshake costs some 0.3 ms. Those of members are given back.
constexpr PeerBudget::Limits kHandshakeLimits{100, 50};
constexpr std::string_view kHeadEnd = "\r\n\r\n";

// A certificate may be read by everybody.
Result<std::string> ReadPem(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string pem(kPemBytesMax + 1, '\0');
  file.read(pem.data(), static_cast<std::streamsize>(pem.size()));
  pem.resize(static_cast<size_t>(file.gcount()));
  if (pem.empty()) return Failed(fmt::format("{}: cannot be read", path));
  return pem;
}

}  // namespace

WebServer::WebServer(Address address, std::optional<WebTls> tls, std::unique_ptr<WebSite> site)
    : address_(std::move(address)),
      tls_(std::move(tls)),
      site_(std::move(site)),
      handshakes_(kHandshakeLimits) {}

WebServer::~WebServer() {
  Stop();
  for (const int socket : sockets_) ::close(socket);
  if (stop_event_ >= 0) ::close(stop_event_);
}

void WebServer::Stop() {
  ::eventfd_write(stop_event_, 1);
  if (thread_.joinable()) thread_.join();
}

Result<std::unique_ptr<WebServer>> WebServer::Start(const Address& address, std::optional<WebTls> tls,
                                                    std::unique_ptr<WebSite> site) {
  TESSERA_CHECK(address.kind == Address::Kind::kTcp);
  std::unique_ptr<WebServer> web(new WebServer(address, std::move(tls), std::move(site)));
  if (web->tls_) {
    if (auto loaded = web->LoadCertificate(); !loaded) return loaded.error();
  }
  web->stop_event_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  const int wake_event = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  web->wake_event_ = std::shared_ptr<const int>(new int(wake_event), [](const int* event) {
    if (*event >= 0) ::close(*event);
    delete event;
  });
  web->sockets_ = ListenOnHost(address.host, web->address_.port);
  if (web->sockets_.empty() || web->stop_event_ < 0 || wake_event < 0) {
    return Failed(
        fmt::format("cannot listen on {} {}: the address is in use or does not belong to this machine",
                    web->tls_ ? "--https" : "--http", address.Text()));
  }
  web->thread_ = std::thread([server = web.get()] { server->Run(); });
  return web;
}

// Open connections keep the certificate that they have begun with.
Result<void> WebServer::LoadCertificate() {
  const auto key = ReadPrivateFile(tls_->key_path);
  if (!key) return key.error();
  const auto certificate = ReadPem(tls_->certificate_path);
  if (!certificate) return certificate.error();
  if (*key + *certificate == loaded_pem_) return {};
  auto server = TlsServer::Make(*key, *certificate, tls_->authorities, tls_->check);
  if (!server) return Failed(fmt::format("{}: {}", tls_->certificate_path, server.error().message));
  server_ = std::move(*server);
  loaded_pem_ = *key + *certificate;
  return {};
}

void WebServer::ReloadCertificate() {
  if (!tls_ || Clock::now() < reload_due_) return;
  reload_due_ = Clock::now() + tls_->reload_interval;
  if (const auto loaded = LoadCertificate(); !loaded)
    failed_.Warn("web_certificate_not_reloaded", "reason=" + LogText(loaded.error().message));
}

void WebServer::Run() {
  while (true) {
    std::vector<pollfd> polled{{stop_event_, POLLIN, 0}, {*wake_event_, POLLIN, 0}};
    for (const int socket : sockets_) polled.push_back({socket, POLLIN, 0});
    const size_t first = polled.size();
    bool has_streams = false;
    for (const WebConnection& each : connections_) {
      polled.push_back({each.socket(), each.awaited(), 0});
      has_streams = has_streams || each.IsStream();
    }
    const milliseconds interval = has_streams ? kStreamInterval : kPollInterval;
    ::poll(polled.data(), polled.size(), static_cast<int>(interval.count()));
    if (polled[0].revents != 0) break;
    eventfd_t count = 0;
    if (polled[1].revents != 0) ::eventfd_read(*wake_event_, &count);
    size_t i = first;
    for (WebConnection& each : connections_) Serve(each, polled[i++].revents != 0);
    const auto now = Clock::now();
    connections_.remove_if([now](const WebConnection& each) { return each.HasEnded(now); });
    ReloadCertificate();
    for (size_t s = 2; s < first; ++s) {
      if (polled[s].revents != 0) Accept(polled[s].fd);
    }
  }
  connections_.clear();
}

// One connection at a time: those that are open are served in between.
void WebServer::Accept(int socket) {
  const int connection = ::accept4(socket, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (connection >= 0) {
    Admit(connection);
  } else if (IsLastingAcceptFailure(errno)) {
    failed_.Warn("web_accept_failed", fmt::format("reason={}", LogText(std::strerror(errno))));
    pollfd stop{stop_event_, POLLIN, 0};
    ::poll(&stop, 1, static_cast<int>(kAcceptPause.count()));
  }
}

void WebServer::Admit(int socket) {
  const sockaddr_storage address = PeerOf(socket);
  const PeerNetwork network = NetworkOf(address);
  if (server_ && !handshakes_.Take(network, Clock::now())) {
    ::close(socket);
    failed_.Warn("web_connections_refused", fmt::format("peer={}", LogText(PeerText(address))));
    return;
  }
  const auto brief = std::ranges::count_if(
      connections_, [](const auto& each) { return !each.IsStream() && !each.IsUpload(); });
  if (static_cast<size_t>(brief) >= kWebConnectionsMax) MakeRoom();
  WebConnection& made = connections_.emplace_back(socket, server_ ? &*server_ : nullptr);
  made.peer.text = PeerText(address);
  made.peer.network = network;
  if (server_) {
    made.peer.own = server_->certificate();
  } else {
    made.peer.is_own_user = IsOfOwnUser(socket);
  }
}

void WebServer::MakeRoom() {
  std::map<PeerNetwork, int> waiting;
  for (const WebConnection& each : connections_)
    waiting[each.peer.network] += each.IsWaitingForRequest() ? 1 : 0;
  const auto largest = std::ranges::max_element(waiting, {}, [](const auto& each) { return each.second; });
  auto found = std::ranges::find_if(connections_, [&](const WebConnection& each) {
    return each.IsWaitingForRequest() && each.peer.network == largest->first;
  });
  if (found == connections_.end())
    found = std::ranges::find_if(
        connections_, [](const WebConnection& each) { return !each.IsStream() && !each.IsUpload(); });
  connections_.erase(found);
}

// An exception, such as for lack of memory, ends the connection alone.
void WebServer::Serve(WebConnection& connection, bool is_ready) {
  using State = WebConnection::State;
  try {
    if (auto answer = connection.TakeLater()) return Deliver(connection, std::move(*answer));
    if (!connection.IsWaitingForRequest()) return connection.Resume(is_ready);
    if (!is_ready) return;
    if (connection.state() == State::kHandshake) Handshake(connection);
    if (connection.state() == State::kReading && connection.Read()) TakeRequest(connection);
  } catch (const std::exception&) {
    connection.Close();
  }
}

void WebServer::Handshake(WebConnection& connection) {
  if (connection.Handshake() || connection.HandshakeFailure().empty()) return;
  failed_.Warn("web_handshake_failed", fmt::format("peer={} reason={}", LogText(connection.peer.text),
                                                   LogText(connection.HandshakeFailure())));
}

// Answers as soon as the request is whole.
void WebServer::TakeRequest(WebConnection& connection) {
  const auto refuse = [&](int status, const char* reason) {
    connection.Send(HttpResponse::Plain(status, reason), Notification());
  };
  const std::string& received = connection.received();
  const size_t end = received.find(kHeadEnd);
  if (end == std::string::npos ? received.size() >= kHttpHeadBytesMax : end >= kHttpHeadBytesMax)
    return refuse(431, "The request is too long.\n");
  if (end == std::string::npos) return;
  const size_t head_size = end + kHeadEnd.size();
  auto request = ParseHttpRequest(std::string_view(received).substr(0, head_size));
  if (!request) return refuse(400, "The request is malformed.\n");
  if (request->has_long_body()) return Receive(connection, *request, head_size);
  if (received.size() - head_size < request->body_size) return;
  request->body = received.substr(head_size, request->body_size);
  Answer(connection, *request);
}

void WebServer::Answer(WebConnection& connection, const HttpRequest& request) {
  HttpResponse response = site_->Answer(request, connection.peer, Clock::now());
  if (response.is_for_member) handshakes_.GiveBack(connection.peer.network);
  if (request.method == "HEAD") connection.OmitBody();
  Deliver(connection, std::move(response));
}

// Whoever may not send the body is refused before it is read.
void WebServer::Receive(WebConnection& connection, const HttpRequest& request, size_t head_size) {
  HttpResponse response = site_->Answer(request, connection.peer, Clock::now());
  if (response.is_for_member) handshakes_.GiveBack(connection.peer.network);
  if (response.sink == nullptr) return Deliver(connection, std::move(response));
  if (!HasPlaceForUpload(response.stream_owner))
    return Deliver(connection,
                   HttpResponse::JsonError(503, "too many uploads are running; wait for one to end"));
  connection.Receive(std::move(response), head_size, request.body_size, Notification());
}

void WebServer::Deliver(WebConnection& connection, HttpResponse response) {
  if (response.IsContinue()) return connection.ReceiveMore();
  if (response.stream != nullptr && !HasPlaceForStream(response.stream_owner))
    response = HttpResponse::JsonError(503, "too many streams are open; close some and try again");
  connection.Send(std::move(response), Notification());
}

bool WebServer::HasPlaceForStream(const std::string& owner) const {
  const auto all = std::ranges::count_if(connections_, &WebConnection::IsStream);
  const auto own = std::ranges::count_if(connections_, [&](const WebConnection& each) {
    return each.IsStream() && each.stream_owner() == owner;
  });
  return all < kStreamsMax && own < kStreamsOfOwnerMax;
}

bool WebServer::HasPlaceForUpload(const std::string& owner) const {
  const auto all = std::ranges::count_if(connections_, &WebConnection::IsUpload);
  const auto own = std::ranges::count_if(connections_, [&](const WebConnection& each) {
    return each.IsUpload() && each.stream_owner() == owner;
  });
  return all < kUploadsMax && own < kUploadsOfOwnerMax;
}

std::function<void()> WebServer::Notification() const {
  return [event = wake_event_] { ::eventfd_write(*event, 1); };
}

}  // namespace tessera
