// A coordinator with a plain web page, whose visitors are programs of the user who runs the coordinator, and
// the requests that the page makes. A worker that prepares what was ordered there.
#pragma once

#include <httplib.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/coordinator/services_fixture.h"

namespace tessera {

class WebServices : public Services {
 protected:
  using json = nlohmann::json;

  WebServices() {
    http = *ParseAddress("127.0.0.1:0", "test");
    Restart();
  }
  // With the same data, at another port.
  void Restart() {
    coordinator.reset();
    Start();
    client = std::make_unique<httplib::Client>("127.0.0.1", port());
    client->set_read_timeout(60);
    proof = json::parse(client->Get("/api/v1/me")->body)["proof"];
  }
  int port() const { return coordinator->http()->port; }
  httplib::Result Post(const std::string& path, const json& body = json::object()) {
    return client->Post("/api/v1/" + path, {{"X-Tessera-Proof", proof}}, body.dump(), "application/json");
  }
  // Calls as a worker until the answer has something to prepare.
  proto::PreparationRequest AwaitPreparation() {
    proto::WorkerDirective directive;
    EXPECT_TRUE(ComesTrue([&] {
      EXPECT_TRUE(Synchronize(Worker(milliseconds(200)), directive).ok());
      return directive.has_preparation();
    }));
    return directive.preparation();
  }
  grpc::Status Report(proto::PreparationReport report, const proto::PreparationRequest& request) {
    LearnFarm();
    report.set_worker(7);
    report.set_farm(WriteFarmId(farm));
    report.set_key(request.key());
    proto::PreparationAnswer answer;
    return Call(*work, &proto::Work::Stub::ReturnPreparation, report, answer);
  }

  std::unique_ptr<httplib::Client> client;
  std::string proof;  // that a request comes from the page
};

}  // namespace tessera
