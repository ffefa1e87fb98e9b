// tessera access
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "proto/identity/certificate.h"
#include "proto/identity/subject.h"

namespace tessera {
namespace {

struct AccessOptions {
  ConnectionOptions connection;
  std::string revoke;
  bool json = false;
};

void AddAccessFlags(CLI::App& app, AccessOptions& options) {
  AddText(app, "--revoke", "WHICH",
          "Revoke members and tokens of this name, or the one with this id; their calls end", options.revoke);
  AddConnectionFlags(app, options.connection);
  AddJsonFlag(app, options.json);
}

const char* StateOf(const MemberStatus& member, UnixTime now) {
  return member.revoked ? "revoked" : member.expires <= now ? "expired" : "valid";
}

const char* StateOf(const TokenStatus& token, UnixTime now) {
  return token.revoked          ? "revoked"
         : token.uses_left == 0 ? "used up"
         : token.expires <= now ? "expired"
                                : "valid";
}

std::string AccessText(const CoordinatorClient::Access& access, UnixTime now) {
  std::string text =
      fmt::format("{:<16}  {:<8}  {:<8}  {:<20}  {}\n", "MEMBER", "ROLE", "STATE", "EXPIRES", "NAME");
  for (const MemberStatus& each : access.members) {
    text += fmt::format("{:<16}  {:<8}  {:<8}  {:<20}  {}\n", MemberIdText(each.id), RoleName(each.role),
                        StateOf(each, now), UnixTimeText(each.expires), each.name);
  }
  text += fmt::format("{:<16}  {:<8}  {:<8}  {:<20}  {:>6}  {}\n", "TOKEN", "ROLE", "STATE", "EXPIRES",
                      "USES", "NAME");
  for (const TokenStatus& each : access.tokens) {
    text +=
        fmt::format("{:<16}  {:<8}  {:<8}  {:<20}  {:>6}  {}\n", TokenIdText(each.key), RoleName(each.role),
                    StateOf(each, now), UnixTimeText(each.expires), each.uses_left, each.name);
  }
  return text;
}

template <typename Status>
nlohmann::ordered_json EntryJson(const std::string& id, const Status& status, UnixTime now) {
  nlohmann::ordered_json json;
  json["id"] = id;
  json["role"] = RoleName(status.role);
  json["name"] = status.name;
  json["state"] = StateOf(status, now);
  json["expires"] = status.expires;
  return json;
}

std::string AccessJson(const CoordinatorClient::Access& access, UnixTime now) {
  nlohmann::ordered_json json{{"members", nlohmann::ordered_json::array()},
                              {"tokens", nlohmann::ordered_json::array()}};
  for (const MemberStatus& each : access.members)
    json["members"].push_back(EntryJson(MemberIdText(each.id), each, now));
  for (const TokenStatus& each : access.tokens) {
    json["tokens"].push_back(EntryJson(TokenIdText(each.key), each, now));
    json["tokens"].back()["uses_left"] = each.uses_left;
  }
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

Result<int> RunAccess(const AccessOptions& options, Cancellation& cancellation) {
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  const auto access = options.revoke.empty() ? (*client)->ListAccess() : (*client)->Revoke(options.revoke);
  if (!access) return access.error();
  fmt::print("{}", options.json ? AccessJson(*access, UnixNow()) : AccessText(*access, UnixNow()));
  return 0;
}

}  // namespace

Command AccessCommand() {
  return MakeCommand<AccessOptions>({
      .name = "access",
      .summary = "List or revoke the members and join tokens of a farm",
      .examples = {{"List members and tokens", "tessera access"},
                   {"Revoke a member by name", "tessera access --revoke ada"}},
      .add_flags = AddAccessFlags,
      .run = RunAccess,
  });
}

}  // namespace tessera
