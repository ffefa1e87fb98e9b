// The read-only web server of a coordinator: `/` for people, `/metrics` for Prometheus.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "coordinator/farm_view.h"
#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace httplib {
class Server;
}

namespace tessera {

// Has a few threads of its own and short timeouts: a slow reader delays other readers at worst, never the
// farm.
class WebServer {
 public:
  // Called for each answer, from any thread; returns nullopt if the farm is too busy.
  using Look = std::function<std::optional<FarmView>()>;
  // An error that names the address if it cannot be listened on.
  static Result<std::unique_ptr<WebServer>> Start(const Address& address, Look look);
  ~WebServer();
  // Takes no new connections and ends the threads.
  void Stop();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  // With the port that was chosen for port 0.
  const Address& address() const { return address_; }

 private:
  WebServer(Address address, Look look);
  void SetUp();

  Address address_;
  Look look_;
  std::unique_ptr<httplib::Server> server_;
  std::thread thread_;
};

}  // namespace tessera
