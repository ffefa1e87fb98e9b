#include "coordinator/access.h"

#include <fmt/format.h>

namespace tessera {
namespace {

// "operator" or "user or operator".
std::string RolesWith(Permission permission) {
  std::string text;
  for (const auto& [role, name] : kRoleNames) {
    if (ReachOf(role, permission) != Reach::kNothing)
      text += fmt::format("{}{}", text.empty() ? "" : " or ", name);
  }
  return text;
}

}  // namespace

std::string Principal::Text() const {
  if (!role) return token_key != Digest{} ? "the holder of a token" : "an unknown caller";
  return fmt::format("{} \"{}\"", RoleName(*role), name);
}

Result<void> AdmitByRole(const Principal& caller, const CallRule& rule) {
  if (ReachOf(caller.role, rule.permission) != Reach::kNothing) return {};
  if (rule.permission == Permission::kJoin)
    return BadInput(fmt::format("{} is a member of the farm already; joining takes a token", caller.Text()));
  return BadInput(fmt::format(
      "{} may not call {}, which needs the role {}; ask an operator of the farm for a token of that role",
      caller.Text(), rule.method, RolesWith(rule.permission)));
}

Result<void> AdmitByOwner(const Principal& caller, const CallRule& rule, JobId job, const JobOwner& owner) {
  const Reach reach = ReachOf(caller.role, rule.permission);
  const bool is_own = caller.member != MemberId{} && caller.member == owner.member;
  if (reach == Reach::kEverything || (reach == Reach::kOwn && is_own)) return {};
  const std::string whose =
      owner.name.empty() ? "has no owner" : fmt::format("belongs to \"{}\"", owner.name);
  return BadInput(
      fmt::format("{} may not call {} for job {}, which {}; ask its owner or an operator of the farm",
                  caller.Text(), rule.method, Number(job), whose));
}

}  // namespace tessera
