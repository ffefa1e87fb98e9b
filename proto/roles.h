// What a member of a farm may be. The rule table of the coordinator (coordinator/access.h) decides what each
// role may do.
#pragma once

#include <optional>
#include <string_view>
#include <utility>

namespace tessera {

enum class Role {
  kWorker,    // renders: takes leases, returns results, fetches scene files
  kUser,      // submits jobs and controls its own
  kViewer,    // looks at jobs, workers and pictures
  kOperator,  // may do everything, including letting others in
};

// The names on command lines and in certificates.
constexpr std::pair<Role, std::string_view> kRoleNames[] = {
    {Role::kWorker, "worker"},
    {Role::kUser, "user"},
    {Role::kViewer, "viewer"},
    {Role::kOperator, "operator"},
};

constexpr std::string_view RoleName(Role role) {
  for (const auto& [each, name] : kRoleNames) {
    if (each == role) return name;
  }
  return "";
}

constexpr std::optional<Role> FindRole(std::string_view name) {
  for (const auto& [role, each] : kRoleNames) {
    if (each == name) return role;
  }
  return std::nullopt;
}

}  // namespace tessera
