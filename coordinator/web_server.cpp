#include "coordinator/web_server.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "coordinator/http_request.h"
#include "coordinator/listen_sockets.h"
#include "coordinator/metrics_text.h"
#include "coordinator/status_page.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr size_t kWebConnectionsMax = 64;  // some browsers and monitoring systems
constexpr seconds kRequestPatience{5};     // for a whole head
constexpr seconds kAnswerPatience{10};     // for the peer to take the answer
constexpr seconds kClosePatience{1};       // for the peer to close after it
constexpr size_t kDroppedBytesMax = 1 << 20;
// Pages are not made more often than this, however many ask for them.
constexpr milliseconds kPageAge{250};
constexpr milliseconds kPollInterval{500};

// The page needs nothing else: even a name that escaped its quotes could load and run nothing.
constexpr const char* kHeaders =
    "Content-Security-Policy: default-src 'none'; style-src 'unsafe-inline'\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "Cache-Control: no-store\r\n"
    "Connection: close\r\n";
constexpr const char* kPlainText = "text/plain; charset=utf-8";

const char* PhraseOf(int status) {
  switch (status) {
    case 200: return "OK";
    case 400: return "Bad Request";
    case 403: return "Forbidden";
    case 404: return "Not Found";
    case 405: return "Method Not Allowed";
    case 431: return "Request Header Fields Too Large";
    default: return "Service Unavailable";
  }
}

}  // namespace

struct WebServer::Connection {
  explicit Connection(int descriptor) : fd(descriptor), deadline(Clock::now() + kRequestPatience) {}
  ~Connection() { ::close(fd); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  // Sends a head and then the body.
  void Send(int status, const char* type, std::shared_ptr<const std::string> text, bool has_body = true) {
    in.clear();
    out = fmt::format("HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n{}{}\r\n", status,
                      PhraseOf(status), type, text->size(), status == 405 ? "Allow: GET, HEAD\r\n" : "",
                      kHeaders);
    body = has_body ? std::move(text) : std::make_shared<const std::string>();
    state = State::kWriting;
    deadline = Clock::now() + kAnswerPatience;
  }
  void Refuse(int status, const char* words) {
    Send(status, kPlainText, std::make_shared<const std::string>(words));
  }

  enum class State { kReading, kWriting, kClosing, kClosed };
  int fd;
  State state = State::kReading;
  Clock::time_point deadline;
  std::string in, out;
  std::shared_ptr<const std::string> body;  // shared by all that read it
  size_t sent = 0;                          // of out and body together
  size_t dropped = 0;
};

WebServer::WebServer(Address address, std::vector<std::string> names, Look look)
    : address_(std::move(address)), names_(std::move(names)), look_(std::move(look)) {}

WebServer::~WebServer() {
  Stop();
  for (const int socket : sockets_) ::close(socket);
  if (stop_event_ >= 0) ::close(stop_event_);
}

void WebServer::Stop() {
  ::eventfd_write(stop_event_, 1);
  if (thread_.joinable()) thread_.join();
}

Result<std::unique_ptr<WebServer>> WebServer::Start(const Address& address, std::vector<std::string> names,
                                                    Look look) {
  TESSERA_CHECK(address.kind == Address::Kind::kTcp);
  std::unique_ptr<WebServer> web(new WebServer(address, std::move(names), std::move(look)));
  web->names_.push_back(address.host);
  web->stop_event_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  web->sockets_ = ListenOnHost(address.host, web->address_.port);
  if (web->sockets_.empty() || web->stop_event_ < 0) {
    return Failed(
        fmt::format("cannot listen on --http {}: the address is in use or does not belong to this machine",
                    address.Text()));
  }
  web->thread_ = std::thread([server = web.get()] { server->Run(); });
  return web;
}

void WebServer::Run() {
  while (true) {
    std::vector<pollfd> polled{{stop_event_, POLLIN, 0}};
    for (const int socket : sockets_) polled.push_back({socket, POLLIN, 0});
    const size_t first = polled.size();
    for (const Connection& each : connections_) {
      const bool is_writing = each.state == Connection::State::kWriting;
      polled.push_back({each.fd, static_cast<short>(is_writing ? POLLOUT : POLLIN), 0});
    }
    ::poll(polled.data(), polled.size(), static_cast<int>(kPollInterval.count()));
    if (polled.front().revents != 0) break;
    size_t i = first;
    for (Connection& each : connections_) Serve(each, polled[i++].revents);
    connections_.remove_if([](const Connection& each) {
      return each.state == Connection::State::kClosed || Clock::now() > each.deadline;
    });
    for (size_t s = 1; s < first; ++s) {
      if (polled[s].revents != 0) Accept(polled[s].fd);
    }
  }
  connections_.clear();
}

// One connection at a time: those that are open are served in between.
void WebServer::Accept(int socket) {
  if (connections_.size() == kWebConnectionsMax) {
    const auto silent = std::ranges::find(connections_, Connection::State::kReading, &Connection::state);
    connections_.erase(silent != connections_.end() ? silent : connections_.begin());
  }
  const int connection = ::accept4(socket, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (connection >= 0) {
    connections_.emplace_back(connection);
  } else if (errno == EMFILE || errno == ENFILE) {
    pollfd stop{stop_event_, POLLIN, 0};
    ::poll(&stop, 1, static_cast<int>(kPageAge.count()));
  }
}

// An exception, such as for lack of memory, ends the connection alone.
void WebServer::Serve(Connection& connection, short events) {
  if (events == 0) return;
  try {
    if (connection.state == Connection::State::kWriting) {
      Write(connection);
    } else {
      Read(connection);
    }
  } catch (const std::exception&) {
    connection.state = Connection::State::kClosed;
  }
}

void WebServer::Read(Connection& connection) {
  char bytes[4096];
  const ssize_t size = ::recv(connection.fd, bytes, sizeof bytes, 0);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) {
    connection.state = Connection::State::kClosed;
    return;
  }
  // What follows a request that was answered is dropped, up to a limit.
  if (connection.state == Connection::State::kClosing) {
    connection.dropped += static_cast<size_t>(size);
    if (connection.dropped > kDroppedBytesMax) connection.state = Connection::State::kClosed;
    return;
  }
  connection.in.append(bytes, static_cast<size_t>(size));
  const bool is_whole = connection.in.find("\r\n\r\n") != std::string::npos;
  if (is_whole && connection.in.find("\r\n\r\n") < kHttpHeadBytesMax) {
    Answer(connection);
  } else if (connection.in.size() >= kHttpHeadBytesMax) {
    connection.Refuse(431, "The request is too long.\n");
  } else {
    return;
  }
  Write(connection);
}

void WebServer::Write(Connection& connection) {
  const size_t head = connection.out.size(), all = head + connection.body->size();
  while (connection.sent < all) {
    const std::string& part = connection.sent < head ? connection.out : *connection.body;
    const size_t at = connection.sent < head ? connection.sent : connection.sent - head;
    const ssize_t size = ::send(connection.fd, part.data() + at, part.size() - at, MSG_NOSIGNAL);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (size < 0) {
      connection.state = Connection::State::kClosed;
      return;
    }
    connection.sent += static_cast<size_t>(size);
  }
  // Closing while unread bytes are there would take the answer away from the peer.
  ::shutdown(connection.fd, SHUT_WR);
  connection.state = Connection::State::kClosing;
  connection.deadline = Clock::now() + kClosePatience;
}

void WebServer::Answer(Connection& connection) {
  const auto request = ParseHttpRequest(connection.in.substr(0, connection.in.find("\r\n\r\n") + 4));
  if (!request) return connection.Refuse(400, "The request is malformed.\n");
  if (!IsOwnHost(request->host, names_))
    return connection.Refuse(403, "The page is not served under this name; see --http-name.\n");
  const bool is_page = request->path == "/";
  if (!is_page && request->path != "/metrics") return connection.Refuse(404, "There is no such page.\n");
  if (request->method != "GET" && request->method != "HEAD")
    return connection.Refuse(405, "Only GET is supported.\n");
  const Page& page = PageAt(request->path, is_page ? StatusPage : MetricsText);
  const char* const type = page.status != 200 ? kPlainText
                           : is_page          ? "text/html; charset=utf-8"
                                              : "text/plain; version=0.0.4; charset=utf-8";
  connection.Send(page.status, type, page.body, request->method == "GET");
}

const WebServer::Page& WebServer::PageAt(const std::string& path, std::string (*write)(const FarmView&)) {
  Page& page = pages_[path];
  if (page.body != nullptr && Clock::now() - page.made < kPageAge) return page;
  const auto view = look_();
  page.status = view ? 200 : 503;
  page.body =
      std::make_shared<const std::string>(view ? write(*view) : "The coordinator is busy. Try again.\n");
  page.made = Clock::now();
  return page;
}

}  // namespace tessera
