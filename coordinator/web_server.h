// The read-only web server of a coordinator: `/` for people, `/metrics` for Prometheus.
#pragma once

#include <chrono>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/farm_view.h"
#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace tessera {

// One thread serves a bounded number of connections, each for a bounded time and with a bounded request.
// Whoever connects when all places are taken gets the place of the connection that has been silent longest,
// so slow and silent peers cannot keep others from the page. The farm is never delayed.
class WebServer {
 public:
  // Called for answers; returns nullopt if the farm is too busy.
  using Look = std::function<std::optional<FarmView>()>;
  // Answers requests for `names` and for numeric addresses, see IsOwnHost. An error that names the address if
  // it cannot be listened on.
  static Result<std::unique_ptr<WebServer>> Start(const Address& address, std::vector<std::string> names,
                                                  Look look);
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
  struct Page {
    std::shared_ptr<const std::string> body;
    int status = 0;
    Clock::time_point made{};
  };

  WebServer(Address address, std::vector<std::string> names, Look look);
  void Run();
  void Accept(int socket);
  void Serve(Connection& connection, short events);
  void Read(Connection& connection);
  void Write(Connection& connection);
  void Answer(Connection& connection);
  const Page& PageAt(const std::string& path, std::string (*write)(const FarmView&));

  Address address_;
  std::vector<std::string> names_;
  Look look_;
  std::vector<int> sockets_;
  int stop_event_ = -1;
  std::list<Connection> connections_;  // oldest first; of the thread
  std::map<std::string, Page> pages_;  // of the thread
  std::thread thread_;
};

}  // namespace tessera
