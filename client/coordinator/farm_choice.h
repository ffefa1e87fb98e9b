// Which farm a command works with, and how this user becomes a member of one.
#pragma once

#include <string>
#include <vector>

#include "proto/identity/login.h"
#include "proto/membership.h"
#include "proto/wire/endpoint.h"
#include "renderer/util/result.h"

namespace tessera {

// If neither an address nor a login is known.
constexpr const char* kCoordinatorDefault = "127.0.0.1:7700";

// What the user said of it. Everything may be empty.
struct FarmChoice {
  std::string coordinator;  // HOST:PORT or unix:PATH
  std::string farm;         // name of a login
  bool insecure = false;    // plain text to an address of this machine
  TlsFiles tls = {};        // certificates of an organisation in place of a login
};

// With certificates of an organisation: the address that is named or the default address. Else the login that
// is named, the address that is named, the last login or the default address, in this order.
Result<Endpoint> ChooseFarm(const FarmChoice& choice);

// As which member the coordinator there knows this user; 0 without a certificate.
Result<MemberId> MemberOf(const Endpoint& endpoint);

struct NewLogin {
  Login login;
  std::string member;  // "user "ada""
};
// Joins the farm of a token and keeps the login as `farm`. Empty: named after the address. `name` is how the
// farm should call this user, unless the token says it. Empty: the name of the account.
Result<NewLogin> LogIn(const std::string& token, const std::string& farm, const std::string& name);

struct EndedLogin {
  Login login;
  std::vector<std::string> others;  // the farms of the logins that are left
  bool has_default = false;         // whether commands without --farm still use one of these
};
// Deletes the login `farm`. Empty: the last one. The certificate stays valid at the coordinator.
Result<EndedLogin> LogOut(const std::string& farm);

}  // namespace tessera
