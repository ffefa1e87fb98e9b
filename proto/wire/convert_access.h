// Conversion of proto/access.proto: values of proto/membership.h from and to messages.
#pragma once

#include "proto/access.pb.h"
#include "proto/membership.h"
#include "renderer/util/result.h"

namespace tessera {

proto::Role WriteRole(Role role);
Result<Role> ReadRole(proto::Role role);
void Write(const TokenStatus& token, proto::TokenStatus& message);
void Write(const MemberStatus& member, proto::MemberStatus& message);
Result<TokenStatus> ReadTokenStatus(const proto::TokenStatus& message);
Result<MemberStatus> ReadMemberStatus(const proto::MemberStatus& message);

}  // namespace tessera
