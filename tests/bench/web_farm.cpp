// Serves the web page of a farm that renders nothing, with any number of jobs and workers, until it is
// interrupted: to look at the page and to measure it.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

#include "coordinator/web/api/web_api.h"
#include "coordinator/web/web_server.h"
#include "tests/coordinator/web/api/synthetic_farm.h"

using namespace tessera;

int main(int argc, char** argv) {
  size_t jobs = 5000, workers = 1000;
  int port = 0;
  CLI::App app("Serve the web page of a farm that renders nothing.");
  app.add_option("--jobs", jobs, "Number of jobs")->capture_default_str();
  app.add_option("--workers", workers, "Number of workers")->capture_default_str();
  app.add_option("--port", port, "Port on 127.0.0.1; 0: any")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  auto site = std::make_unique<WebSite>(std::vector<std::string>(),
                                        std::make_shared<WebApi>(SyntheticFarm(jobs, workers)), std::nullopt);
  auto web =
      WebServer::Start(*ParseAddress("127.0.0.1:" + std::to_string(port), "--port"), {}, std::move(site));
  if (!web) {
    std::fprintf(stderr, "%s\n", web.error().message.c_str());
    return 1;
  }
  std::printf("http://%s/\n", (*web)->address().Text().c_str());
  std::fflush(stdout);
  int signal = 0;
  sigwait(&signals, &signal);
  return 0;
}
