// Serves proto/access.proto: tokens, joining, renewal, revocation. Thread safe.
#pragma once

#include <string>
#include <vector>

#include "coordinator/call_gate.h"
#include "proto/access.grpc.pb.h"
#include "proto/identity/authority.h"

namespace tessera {

// Long enough for machines that are used now and then, short enough for what was lost to become useless.
constexpr std::chrono::hours kMemberLifetime{24 * 90};
constexpr std::chrono::hours kTokenLifetimeMax{24 * 365};

class AccessService final : public proto::Access::Service {
 public:
  // `authority` is null if the coordinator only uses plain connections: then nobody can join. `addresses` are
  // those under which others reach the coordinator, the most useful first.
  AccessService(const CallGate& gate, const Authority* authority, std::vector<std::string> addresses);

  grpc::ServerUnaryReactor* Join(grpc::CallbackServerContext* context, const proto::JoinRequest* request,
                                 proto::JoinAnswer* answer);
  grpc::ServerUnaryReactor* Renew(grpc::CallbackServerContext* context, const proto::RenewRequest* request,
                                  proto::RenewAnswer* answer);
  grpc::ServerUnaryReactor* IssueToken(grpc::CallbackServerContext* context,
                                       const proto::TokenRequest* request, proto::TokenAnswer* answer);
  grpc::ServerUnaryReactor* ListAccess(grpc::CallbackServerContext* context,
                                       const proto::AccessRequest* request, proto::AccessAnswer* answer);
  grpc::ServerUnaryReactor* Revoke(grpc::CallbackServerContext* context, const proto::RevokeRequest* request,
                                   proto::AccessAnswer* answer);

 private:
  Result<std::string> Sign(const std::string& request, const MemberStatus& member) const;

  const CallGate& gate_;
  const Authority* const authority_;
  const std::vector<std::string> addresses_;
};

}  // namespace tessera
