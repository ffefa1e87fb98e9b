// A farm whose programs run on hosts of their own. Host 0 coordinates, 1 and 2 render, and a user sits at 3.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "tests/end_to_end/farm_fixture.h"
#include "tests/hosts/network.h"

namespace tessera {

class FarmOnHosts : public EndToEnd {
 protected:
  static constexpr int kCoordinatorHost = 0, kFirstWorker = 1, kSecondWorker = 2, kUserHost = 3, kHosts = 4;

  // Skips the test if this machine cannot have hosts.
  void SetUp() override;
  void TearDown() override;

  Network& network() { return *network_; }
  // Starts a line of a shell on a host, in the home of its user.
  Process& Type(int host, const std::string& line);
  Outcome TypeAndWait(int host, const std::string& line);
  std::string Home(int host) const { return Path("host-" + std::to_string(host)); }
  // Puts the scene of a test into the home of the user of a host, as scene.pbrt.
  void PutScene(int host) const;

  // Coordinator, two workers and a user who has logged in.
  void StartFarm();
  // Tokens are made on the host of the coordinator.
  std::string Token(const std::string& options);
  // The picture of the scene, rendered in one process, with these options.
  std::string Expected(const std::string& options);
  // A number in the status of the only job; nullopt if there is no job yet.
  std::optional<double> JobFigure(const std::string& key);
  // Waits until this share of the samples of the only job is merged.
  void AwaitShareOfJob(double share);

  Process& worker(int host) { return *workers_.at(static_cast<size_t>(host - kFirstWorker)); }

 private:
  std::vector<std::string> ShellWords(int host, const std::string& line) const;

  std::optional<Network> network_;
  std::deque<Process> processes_;  // keeps references valid
  std::vector<Process*> workers_;
};

}  // namespace tessera
