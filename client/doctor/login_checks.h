// Checks of the farms that this machine belongs to: keys, certificates, the way to the coordinator, its
// version and its clock.
#pragma once

#include <stop_token>
#include <string>

#include "client/doctor/finding.h"
#include "proto/identity/login.h"
#include "proto/wire/endpoint.h"

namespace tessera {

// All logins in a folder. `kind` names them: "login" or "worker of farm".
Findings CheckLogins(const LoginStore& logins, const std::string& kind, std::stop_token stop);

// The way to a coordinator and what it answers.
Findings CheckCoordinatorAt(const std::string& where, const Endpoint& endpoint, std::stop_token stop);

}  // namespace tessera
