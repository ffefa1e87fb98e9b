#include "proto/wire/convert_access.h"

#include "proto/terms.h"
#include "proto/wire/convert.h"

namespace tessera {
namespace {

constexpr std::pair<Role, proto::Role> kRoles[] = {{Role::kWorker, proto::ROLE_WORKER},
                                                   {Role::kUser, proto::ROLE_USER},
                                                   {Role::kViewer, proto::ROLE_VIEWER},
                                                   {Role::kOperator, proto::ROLE_OPERATOR}};

}  // namespace

proto::Role WriteRole(Role role) {
  for (const auto& [each, message] : kRoles) {
    if (each == role) return message;
  }
  return proto::ROLE_UNKNOWN;
}

Result<Role> ReadRole(proto::Role role) {
  for (const auto& [each, message] : kRoles) {
    if (message == role) return each;
  }
  return BadInput("message refused: the role is unknown");
}

void Write(const TokenStatus& token, proto::TokenStatus& message) {
  message.set_key(WriteDigest(token.key));
  message.set_role(WriteRole(token.role));
  message.set_name(token.name);
  message.set_issued(token.issued);
  message.set_expires(token.expires);
  message.set_uses_left(token.uses_left);
  message.set_revoked(token.revoked);
}

void Write(const MemberStatus& member, proto::MemberStatus& message) {
  message.set_member(Number(member.id));
  message.set_role(WriteRole(member.role));
  message.set_name(member.name);
  message.set_joined(member.joined);
  message.set_expires(member.expires);
  message.set_revoked(member.revoked);
}

Result<TokenStatus> ReadTokenStatus(const proto::TokenStatus& message) {
  const auto key = ReadDigest(message.key(), "key");
  if (!key) return key.error();
  const auto role = ReadRole(message.role());
  if (!role) return role.error();
  return TokenStatus{*key,
                     *role,
                     CleanName(message.name()),
                     message.issued(),
                     message.expires(),
                     message.uses_left(),
                     message.revoked()};
}

Result<MemberStatus> ReadMemberStatus(const proto::MemberStatus& message) {
  const auto role = ReadRole(message.role());
  if (!role) return role.error();
  return MemberStatus{MemberId{message.member()}, *role, CleanName(message.name()), message.joined(),
                      message.expires(),          {},    message.revoked()};
}

}  // namespace tessera
