#include "coordinator/access.h"

#include <fmt/format.h>

namespace tessera {
namespace {

// "operator" or "user or operator".
std::string RolesWith(Permission permission) {
  std::string text;
  for (const auto& [role, name] : kRoleNames) {
    if (May(role, permission)) text += fmt::format("{}{}", text.empty() ? "" : " or ", name);
  }
  return text;
}

}  // namespace

std::string Principal::Text() const {
  if (!role) return "the holder of a token";
  return fmt::format("{} \"{}\"", RoleName(*role), name);
}

Result<void> AdmitByRole(const Principal& caller, const CallRule& rule) {
  if (May(caller.role, rule.permission)) return {};
  if (rule.permission == Permission::kJoin)
    return BadInput(fmt::format("{} is a member of the farm already; joining takes a token", caller.Text()));
  return BadInput(fmt::format(
      "{} may not call {}, which needs the role {}; ask an operator of the farm for a token of that role",
      caller.Text(), rule.method, RolesWith(rule.permission)));
}

}  // namespace tessera
