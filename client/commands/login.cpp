// tessera login
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "client/commands/commands.h"
#include "client/commands/option_groups.h"
#include "client/coordinator/farm_choice.h"
#include "proto/shell/console.h"
#include "proto/shell/flags.h"
#include "proto/shell/secret_words.h"

namespace tessera {
namespace {

struct LoginOptions {
  std::string token;
  std::string farm;  // its name here; empty: its address
  std::string name;  // of this person; empty: the name of the account
  bool json = false;
};

void AddLoginFlags(CLI::App& app, LoginOptions& options) {
  AddText(app, "TOKEN", "", "The word that tessera-coordinator token printed; -: read it from standard input",
          options.token, Presence::kRequired);
  AddText(app, "--farm", "NAME",
          WithDefault("Name of this login, for --farm of other commands", "the address"), options.farm);
  AddText(app, "--name", "NAME",
          WithDefault("How the farm should call you, unless the token names you", "the name of your account"),
          options.name);
  AddJsonFlag(app, options.json);
}

Result<void> CheckLogin(const LoginOptions& options) {
  if (options.farm.empty() || IsFarmName(options.farm)) return {};
  return BadInput(fmt::format("--farm {}: use letters, digits and \". _ -\"", options.farm));
}

Result<int> RunLogin(const LoginOptions& options, Cancellation& cancellation) {
  const auto token = WordOrInput(options.token, cancellation.token());
  if (!token) return Error{token.error().kind, "TOKEN: " + token.error().message};
  const auto done = LogIn(*token, options.farm, options.name);
  if (!done) return done.error();
  PrintNote("logged in to {} as {}; kept as \"{}\" in {}\n", done->login.address, done->member,
            done->login.farm, done->login.folder);
  if (options.json) {
    const nlohmann::ordered_json json{{"coordinator", done->login.address},
                                      {"member", done->member},
                                      {"farm", done->login.farm},
                                      {"folder", done->login.folder}};
    fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }
  return 0;
}

}  // namespace

Command LoginCommand() {
  return MakeCommand<LoginOptions>({
      .name = "login",
      .summary = "Join a farm with a token of its operator",
      .examples = {{"Join a farm and call it studio", "tessera login TOKEN --farm studio"}},
      .add_flags = AddLoginFlags,
      .check = CheckLogin,
      .run = RunLogin,
  });
}

}  // namespace tessera
