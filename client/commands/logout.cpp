// tessera logout
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "client/commands/commands.h"
#include "client/commands/option_groups.h"
#include "client/coordinator/farm_choice.h"
#include "proto/shell/console.h"
#include "proto/shell/flags.h"

namespace tessera {
namespace {

struct LogoutOptions {
  std::string farm;  // empty: that of the last login
  bool json = false;
};

void AddLogoutFlags(CLI::App& app, LogoutOptions& options) {
  AddText(app, "FARM", "", WithDefault("Name of the login", "the last login"), options.farm);
  AddJsonFlag(app, options.json);
}

Result<int> RunLogout(const LogoutOptions& options, Cancellation&) {
  const auto ended = LogOut(options.farm);
  if (!ended) return ended.error();
  PrintNote("logged out of {}: its key is deleted from {}\n", ended->login.address, ended->login.folder);
  if (!ended->others.empty() && !ended->has_default)
    PrintNote("no login is the last one now: give other commands --farm ({})\n",
              fmt::join(ended->others, ", "));
  if (options.json) {
    const nlohmann::ordered_json json{
        {"coordinator", ended->login.address}, {"farm", ended->login.farm}, {"folder", ended->login.folder}};
    fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }
  return 0;
}

}  // namespace

Command LogoutCommand() {
  return MakeCommand<LogoutOptions>({
      .name = "logout",
      .summary = "Delete the key of a login from this machine",
      .examples = {{"Leave the farm called studio", "tessera logout studio"}},
      .add_flags = AddLogoutFlags,
      .run = RunLogout,
  });
}

}  // namespace tessera
