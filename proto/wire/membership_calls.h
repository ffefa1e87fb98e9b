// Becoming and staying a member of a farm, for workers and for people.
#pragma once

#include <memory>
#include <string>

#include "proto/identity/join_token.h"
#include "proto/identity/login.h"
#include "proto/membership.h"
#include "renderer/util/result.h"

namespace grpc {
class Channel;
}

namespace tessera {

struct JoinedFarm {
  IssuedIdentity identity;
  MemberId member{};
  Role role{};
  std::string name;  // as the farm calls the new member
};

// Makes a key, sends a signing request to the coordinator of the token and returns the certificate. `name` is
// how the new member would like to be called. The error says what is wrong with the token or the coordinator.
Result<JoinedFarm> JoinFarm(const JoinToken& token, const std::string& name);

// Gets a new certificate over `channel` and keeps it, if a third of the life of the present one is over.
// Returns whether it did.
Result<bool> RenewIfDue(const Login& login, const std::shared_ptr<grpc::Channel>& channel);

}  // namespace tessera
