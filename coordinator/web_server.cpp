#include "coordinator/web_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <vector>

#include "coordinator/metrics_text.h"
#include "coordinator/status_page.h"

namespace tessera {
namespace {

constexpr int kThreads = 4;  // some browsers and a monitoring system
// Connections accepted and not yet served; more wait in the kernel.
constexpr size_t kWaitingMax = 32;
// For each read and write of a connection.
constexpr std::chrono::seconds kIoPatience{2};
constexpr size_t kRequestsPerConnectionMax = 100;
constexpr time_t kKeepAlive_s = 2;
constexpr size_t kBodyBytesMax = 1024;  // requests have no body

// Threads that serve connections. While all are busy and kWaitingMax connections wait, no more are accepted,
// which bounds the number of open connections.
class BoundedPool final : public httplib::TaskQueue {
 public:
  BoundedPool() {
    for (int i = 0; i < kThreads; ++i) threads_.emplace_back([this] { Run(); });
  }
  void enqueue(std::function<void()> task) override {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return tasks_.size() < kWaitingMax || stopping_; });
    tasks_.push_back(std::move(task));
    changed_.notify_all();
  }
  void shutdown() override {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  void Run() {
    while (true) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return !tasks_.empty() || stopping_; });
      if (tasks_.empty()) return;
      const std::function<void()> task = std::move(tasks_.front());
      tasks_.pop_front();
      changed_.notify_all();
      lock.unlock();
      task();
    }
  }
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;  // guarded by mutex_
  bool stopping_ = false;                    // guarded by mutex_
  std::vector<std::thread> threads_;
};

// A port that another process listens on is an error, so no SO_REUSEPORT.
void SetSocketOptions(socket_t socket) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

}  // namespace

WebServer::WebServer(Address address, Look look)
    : address_(std::move(address)), look_(std::move(look)), server_(std::make_unique<httplib::Server>()) {}

WebServer::~WebServer() {
  Stop();
}

void WebServer::Stop() {
  server_->stop();
  if (thread_.joinable()) thread_.join();
}

void WebServer::SetUp() {
  server_->new_task_queue = [] { return new BoundedPool; };  // the library deletes it
  server_->set_socket_options(SetSocketOptions);
  server_->set_read_timeout(kIoPatience);
  server_->set_write_timeout(kIoPatience);
  server_->set_keep_alive_max_count(kRequestsPerConnectionMax);
  server_->set_keep_alive_timeout(kKeepAlive_s);
  server_->set_payload_max_length(kBodyBytesMax);
  // The page needs nothing else: even a name that escaped its quotes could load and run nothing.
  server_->set_default_headers({{"Content-Security-Policy", "default-src 'none'; style-src 'unsafe-inline'"},
                                {"X-Content-Type-Options", "nosniff"},
                                {"Cache-Control", "no-store"}});
  const auto serve = [this](const char* type, std::string (*write)(const FarmView&)) {
    return [this, type, write](const httplib::Request&, httplib::Response& response) {
      const auto view = look_();
      if (view) {
        response.set_content(write(*view), type);
        return;
      }
      response.status = 503;
      response.set_content("The coordinator is busy. Try again.\n", "text/plain; charset=utf-8");
    };
  };
  server_->Get("/", serve("text/html; charset=utf-8", StatusPage));
  server_->Get("/metrics", serve("text/plain; version=0.0.4; charset=utf-8", MetricsText));
}

Result<std::unique_ptr<WebServer>> WebServer::Start(const Address& address, Look look) {
  TESSERA_CHECK(address.kind == Address::Kind::kTcp);
  std::unique_ptr<WebServer> web(new WebServer(address, std::move(look)));
  web->SetUp();
  httplib::Server& server = *web->server_;
  const bool any = address.port == 0;
  const int port = any                                               ? server.bind_to_any_port(address.host)
                   : server.bind_to_port(address.host, address.port) ? address.port
                                                                     : -1;
  if (port <= 0) {
    return Failed(
        fmt::format("cannot listen on --http {}: the address is in use or does not belong to this machine",
                    address.Text()));
  }
  web->address_.port = port;
  web->thread_ = std::thread([&server] { server.listen_after_bind(); });
  // A stop before that would have no effect.
  while (!server.is_running()) std::this_thread::yield();
  return web;
}

}  // namespace tessera
