// The calls of CoordinatorClient about members and tokens.
#include <fmt/format.h>

#include "client/coordinator/coordinator_client.h"
#include "client/coordinator/coordinator_connection.h"
#include "proto/wire/convert.h"
#include "proto/wire/convert_access.h"

namespace tessera {
namespace {

Result<CoordinatorClient::Access> ReadAccess(const proto::AccessAnswer& answer) {
  CoordinatorClient::Access access;
  for (const proto::TokenStatus& message : answer.tokens()) {
    auto token = ReadTokenStatus(message);
    if (!token) return token.error();
    access.tokens.push_back(std::move(*token));
  }
  for (const proto::MemberStatus& message : answer.members()) {
    auto member = ReadMemberStatus(message);
    if (!member) return member.error();
    access.members.push_back(std::move(*member));
  }
  return access;
}

}  // namespace

Result<CoordinatorClient::Access> CoordinatorClient::ListAccess() {
  proto::AccessAnswer answer;
  const auto asked = WithRetries(*connection_, "list members and tokens", [&] {
    CallContext context(connection_->stop, connection_->farm, kCallPatience);
    return connection_->access->ListAccess(context.get(), proto::AccessRequest(), &answer);
  });
  if (!asked) return asked.error();
  return ReadAccess(answer);
}

Result<CoordinatorClient::Access> CoordinatorClient::Revoke(const std::string& which) {
  proto::RevokeRequest request;
  request.set_which(CleanName(which));
  proto::AccessAnswer answer;
  const auto asked = WithRetries(*connection_, fmt::format("revoke \"{}\"", CleanName(which)), [&] {
    CallContext context(connection_->stop, connection_->farm, kCallPatience);
    return connection_->access->Revoke(context.get(), request, &answer);
  });
  if (!asked) return asked.error();
  return ReadAccess(answer);
}

}  // namespace tessera
