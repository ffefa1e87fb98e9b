#include "coordinator/web/web_server.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <map>

#include "coordinator/listener/listen_sockets.h"
#include "coordinator/web/web_stream.h"
#include "proto/identity/private_file.h"
#include "proto/identity/private_key.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Step = WebStream::Step;

constexpr size_t kWebConnectionsMax = 64;  // some browsers and monitoring systems
constexpr seconds kRequestPatience{5};     // for the handshake and a whole request
constexpr seconds kAnswerPatience{10};     // for the peer to take the answer
constexpr seconds kClosePatience{1};       // for the peer to close after it
constexpr size_t kDroppedBytesMax = 1 << 20;
constexpr milliseconds kPollInterval{500};
constexpr milliseconds kDescriptorPause{250};
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

struct WebServer::Connection {
  enum class State { kHandshake, kReading, kWriting, kClosing, kClosed };

  Connection(int socket, const TlsServer* tls)
      : stream(socket, tls), deadline(Clock::now() + kRequestPatience) {}

  bool IsWaitingForRequest() const { return state == State::kHandshake || state == State::kReading; }

  void Send(const HttpResponse& response, bool has_body = true) {
    in.clear();
    out = response.Head();
    body = has_body ? response.body : std::make_shared<const std::string>();
    state = State::kWriting;
    deadline = Clock::now() + kAnswerPatience;
    Write();
  }

  void Write() {
    while (sent < out.size() + body->size()) {
      const bool is_head = sent < out.size();
      const std::string_view part =
          is_head ? std::string_view(out).substr(sent) : std::string_view(*body).substr(sent - out.size());
      size_t size = 0;
      if (!Continue(stream.Write(part, size))) return;
      sent += size;
    }
    // Closing while unread bytes are there would take the answer away from the peer.
    stream.EndWriting();
    state = State::kClosing;
    awaited = POLLIN;
    deadline = Clock::now() + kClosePatience;
  }

  // What follows a request that was answered is dropped, up to a limit.
  void Drop() {
    bool is_open = true;
    dropped += stream.Drop(is_open);
    if (!is_open || dropped > kDroppedBytesMax) state = State::kClosed;
  }

  // Whether a step is done. Otherwise it is repeated later, or the connection is closed.
  bool Continue(Step step) {
    if (step == Step::kFailed) state = State::kClosed;
    if (step == Step::kAwaitRead) awaited = POLLIN;
    if (step == Step::kAwaitWrite) awaited = POLLOUT;
    return step == Step::kDone;
  }

  WebStream stream;
  WebPeer peer;
  State state = State::kHandshake;
  short awaited = POLLIN;
  Clock::time_point deadline;
  std::string in, out;
  std::shared_ptr<const std::string> body;  // shared by all that read it
  size_t sent = 0;                          // of out and body together
  size_t dropped = 0;
};

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
  web->sockets_ = ListenOnHost(address.host, web->address_.port);
  if (web->sockets_.empty() || web->stop_event_ < 0) {
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
    std::vector<pollfd> polled{{stop_event_, POLLIN, 0}};
    for (const int socket : sockets_) polled.push_back({socket, POLLIN, 0});
    const size_t first = polled.size();
    for (const Connection& each : connections_) polled.push_back({each.stream.socket(), each.awaited, 0});
    ::poll(polled.data(), polled.size(), static_cast<int>(kPollInterval.count()));
    if (polled.front().revents != 0) break;
    size_t i = first;
    for (Connection& each : connections_) {
      if (polled[i++].revents != 0) Serve(each);
    }
    connections_.remove_if([](const Connection& each) {
      return each.state == Connection::State::kClosed || Clock::now() > each.deadline;
    });
    ReloadCertificate();
    for (size_t s = 1; s < first; ++s) {
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
  } else if (errno == EMFILE || errno == ENFILE) {
    pollfd stop{stop_event_, POLLIN, 0};
    ::poll(&stop, 1, static_cast<int>(kDescriptorPause.count()));
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
  if (connections_.size() == kWebConnectionsMax) MakeRoom();
  Connection& made = connections_.emplace_back(socket, server_ ? &*server_ : nullptr);
  made.peer.text = PeerText(address);
  made.peer.network = network;
  if (server_) made.peer.own = server_->certificate();
}

void WebServer::MakeRoom() {
  std::map<PeerNetwork, int> waiting;
  for (const Connection& each : connections_)
    waiting[each.peer.network] += each.IsWaitingForRequest() ? 1 : 0;
  const auto largest = std::ranges::max_element(waiting, {}, [](const auto& each) { return each.second; });
  const auto found = std::ranges::find_if(connections_, [&](const Connection& each) {
    return each.IsWaitingForRequest() && each.peer.network == largest->first;
  });
  connections_.erase(found != connections_.end() ? found : connections_.begin());
}

// An exception, such as for lack of memory, ends the connection alone.
void WebServer::Serve(Connection& connection) {
  using State = Connection::State;
  try {
    if (connection.state == State::kHandshake) Handshake(connection);
    if (connection.state == State::kReading) return Read(connection);
    if (connection.state == State::kWriting) return connection.Write();
    if (connection.state == State::kClosing) connection.Drop();
  } catch (const std::exception&) {
    connection.state = State::kClosed;
  }
}

void WebServer::Handshake(Connection& connection) {
  const Step step = connection.stream.Handshake();
  if (step == Step::kFailed && !connection.stream.reason().empty()) {
    failed_.Warn("web_handshake_failed", fmt::format("peer={} reason={}", LogText(connection.peer.text),
                                                     LogText(connection.stream.reason())));
  }
  if (!connection.Continue(step)) return;
  connection.peer.certificate = connection.stream.PeerCertificate();
  connection.state = Connection::State::kReading;
  connection.awaited = POLLIN;
}

void WebServer::Read(Connection& connection) {
  char bytes[TlsStream::kRecordBytesMax];
  size_t size = 0;
  if (!connection.Continue(connection.stream.Read(bytes, sizeof bytes, size))) return;
  connection.in.append(bytes, size);
  TakeRequest(connection);
}

// Answers as soon as the request is whole.
void WebServer::TakeRequest(Connection& connection) {
  const size_t end = connection.in.find(kHeadEnd);
  if (end == std::string::npos ? connection.in.size() >= kHttpHeadBytesMax : end >= kHttpHeadBytesMax)
    return connection.Send(HttpResponse::Plain(431, "The request is too long.\n"));
  if (end == std::string::npos) return;
  const size_t head_size = end + kHeadEnd.size();
  auto request = ParseHttpRequest(std::string_view(connection.in).substr(0, head_size));
  if (!request) return connection.Send(HttpResponse::Plain(400, "The request is malformed.\n"));
  if (request->body_size > kHttpBodyBytesMax)
    return connection.Send(HttpResponse::Plain(413, "The request is too long.\n"));
  if (connection.in.size() - head_size < request->body_size) return;
  request->body = connection.in.substr(head_size, request->body_size);
  Answer(connection, *request);
}

void WebServer::Answer(Connection& connection, const HttpRequest& request) {
  const HttpResponse response = site_->Answer(request, connection.peer, Clock::now());
  if (response.is_for_member) handshakes_.GiveBack(connection.peer.network);
  connection.Send(response, request.method != "HEAD");
}

}  // namespace tessera
