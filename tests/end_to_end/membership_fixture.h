// A farm whose members join with tokens.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {

class MembershipOfAFarm : public EndToEnd {
 protected:
  MembershipOfAFarm() { StartCoordinator(); }

  // A token as printed for this user.
  std::string Token(std::vector<std::string> options) const {
    options.insert(options.begin(), "token");
    options.insert(options.end(), {"--coordinator", address()});
    const Outcome outcome = RunProgram(folder(), "tessera-coordinator", options);
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    return outcome.output.substr(0, outcome.output.find('\n'));
  }
  // The client of a person whose logins are in a folder of this name.
  Outcome As(const std::string& person, const std::string& command) const {
    return RunShell(folder(), "XDG_CONFIG_HOME=" + Path(person) + " $tessera " + command);
  }
  void LogIn(const std::string& person, const std::string& role) const {
    const Outcome outcome = As(person, "login " + Token({"--role", role, "--name", person}));
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
  }
  Process& JoinWorker(const std::string& name, const std::string& token) {
    return StartUnaddressedWorker(name, {"--join", token, "--state-dir", Path("state-" + name)});
  }
};

}  // namespace tessera
