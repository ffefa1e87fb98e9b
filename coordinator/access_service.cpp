#include "coordinator/access_service.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "coordinator/message_guard.h"
#include "proto/identity/subject.h"
#include "proto/shell/system.h"
#include "proto/wire/convert.h"
#include "proto/wire/convert_access.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

UnixTime MemberExpiry(UnixTime now) {
  return now + std::chrono::seconds(kMemberLifetime).count();
}

grpc::Status NoAuthority() {
  return {grpc::StatusCode::FAILED_PRECONDITION,
          "nobody can join this coordinator: it listens on no TCP address, or was started with --insecure"};
}

// Fields of a log line. `what`: what becomes of the member or token.
std::string MemberLog(const char* what, const MemberStatus& member) {
  return fmt::format("{}={} role={} name={}", what, MemberIdText(member.id), RoleName(member.role),
                     LogText(member.name));
}

std::string TokenLog(const char* what, const TokenStatus& token) {
  return fmt::format("{}={} role={} name={}", what, TokenIdText(token.key), RoleName(token.role),
                     LogText(token.name));
}

bool IsMeant(const std::string& which, const std::string& id, const std::string& name) {
  return !which.empty() && (which == id || which == name);
}

// Revokes what `which` means and lists it.
void RevokeAll(MembershipLedger& ledger, const std::string& which, proto::AccessAnswer& answer) {
  std::vector<MemberId> members;
  std::vector<Digest> tokens;
  for (const auto& [id, member] : ledger.members()) {
    if (IsMeant(which, MemberIdText(id), member.name)) members.push_back(id);
  }
  for (const auto& [key, token] : ledger.tokens()) {
    if (IsMeant(which, TokenIdText(key), token.name)) tokens.push_back(key);
  }
  for (const MemberId id : members) {
    if (ledger.RevokeMember(id))
      spdlog::info("member_revoked {}", MemberLog("member", ledger.members().at(id)));
    Write(ledger.members().at(id), *answer.add_members());
  }
  for (const Digest& key : tokens) {
    if (ledger.RevokeToken(key)) spdlog::info("token_revoked {}", TokenLog("token", ledger.tokens().at(key)));
    Write(ledger.tokens().at(key), *answer.add_tokens());
  }
}

}  // namespace

AccessService::AccessService(const CallGate& gate, const Authority* authority,
                             std::vector<std::string> addresses)
    : gate_(gate), authority_(authority), addresses_(std::move(addresses)) {
  const auto serve = [this](auto method, const CallRule& rule) {
    MarkMethodCallback(MethodIndex(rule), GuardedMethod(this, rule, method));
  };
  serve(&AccessService::Join, RuleFor("Access.Join"));
  serve(&AccessService::Renew, RuleFor("Access.Renew"));
  serve(&AccessService::IssueToken, RuleFor("Access.IssueToken"));
  serve(&AccessService::ListAccess, RuleFor("Access.ListAccess"));
  serve(&AccessService::Revoke, RuleFor("Access.Revoke"));
}

Result<std::string> AccessService::Sign(const std::string& request, const MemberStatus& member) const {
  CertificateTerms terms;
  terms.common_name = member.name;
  terms.uri = Subject{member.role, member.id, {}}.Uri();
  terms.lifetime = kMemberLifetime;
  terms.serial = RandomId() >> 1;  // positive as a signed number too
  const auto certificate = authority_->Sign(request, terms, UnixNow());
  if (!certificate) return certificate.error();
  return certificate->Pem();
}

// The certificate is made before the token is used, so that a bad request does not use it up. No certificate
// is signed for a token that cannot be used.
grpc::ServerUnaryReactor* AccessService::Join(grpc::CallbackServerContext* context,
                                              const proto::JoinRequest* request, proto::JoinAnswer* answer) {
  return gate_.Unary(context, RuleFor("Access.Join"), [=, this](const UnaryCall& call) {
    const auto token = gate_.core().members().FindToken(call.caller().token_key);
    if (authority_ == nullptr || !token) return call.Finish(NoAuthority());
    const UnixTime now = UnixNow();
    if (const std::string why = WhyUnusable(now, *token); !why.empty())
      return call.Finish(ToStatus(UnusableToken(why)));
    MemberStatus member{MemberId{RandomId()}, token->role, token->name, now, MemberExpiry(now), token->key};
    if (member.name.empty()) member.name = CleanName(request->name());
    if (member.name.empty()) member.name = RoleName(member.role);
    const auto certificate = Sign(request->signing_request(), member);
    if (!certificate) return call.Finish(ToStatus(certificate.error()));
    answer->set_certificate(*certificate);
    answer->set_name(member.name);
    answer->set_role(WriteRole(member.role));
    answer->set_member(Number(member.id));
    call.Note(MemberLog("joined", member));
    const auto join = [=](CoreContext& core) {
      const auto joined = core.farm.membership().Join(now, member);
      return joined ? grpc::Status::OK : ToStatus(joined.error());
    };
    // A certificate that is not recorded is not sent, so its token can be used again.
    call.Apply(join, 0, [id = member.id](CoreContext& core) { core.farm.membership().UndoJoin(id); });
  });
}

grpc::ServerUnaryReactor* AccessService::Renew(grpc::CallbackServerContext* context,
                                               const proto::RenewRequest* request,
                                               proto::RenewAnswer* answer) {
  return gate_.Unary(context, RuleFor("Access.Renew"), [=, this](const UnaryCall& call) {
    const auto member = gate_.core().members().FindMember(call.caller().member);
    if (authority_ == nullptr || !member) return call.Finish(NoAuthority());
    if (member->IsOfOrganisation()) {
      return call.Finish({grpc::StatusCode::FAILED_PRECONDITION,
                          "certificates of an organisation are renewed by its own authority"});
    }
    const auto certificate = Sign(request->signing_request(), *member);
    if (!certificate) return call.Finish(ToStatus(certificate.error()));
    answer->set_certificate(*certificate);
    call.Apply([=, id = member->id](CoreContext& core) {
      const UnixTime now = UnixNow();
      const auto renewed = core.farm.membership().Renew(now, id, MemberExpiry(now));
      return renewed ? grpc::Status::OK : ToStatus(renewed.error());
    });
  });
}

grpc::ServerUnaryReactor* AccessService::IssueToken(grpc::CallbackServerContext* context,
                                                    const proto::TokenRequest* request,
                                                    proto::TokenAnswer* answer) {
  return gate_.Unary(context, RuleFor("Access.IssueToken"), [=, this](const UnaryCall& call) {
    if (authority_ == nullptr) return call.Finish(NoAuthority());
    const auto key = ReadDigest(request->key(), "key");
    if (!key) return call.Finish(ToStatus(key.error()));
    const auto role = ReadRole(request->role());
    if (!role) return call.Finish(ToStatus(role.error()));
    const uint64_t lifetime = request->lifetime_s();
    if (lifetime > static_cast<uint64_t>(std::chrono::seconds(kTokenLifetimeMax).count()))
      return call.Finish(ToStatus(BadInput("message refused: the time to live is out of range")));
    const UnixTime now = UnixNow();
    const TokenStatus token{
        *key, *role, CleanName(request->name()), now, now + static_cast<UnixTime>(lifetime), request->uses()};
    const Digest authority = authority_->certificate().Fingerprint();
    answer->set_authority(WriteDigest(authority));
    for (const std::string& each : addresses_) answer->add_addresses(each);
    answer->set_expires(token.expires);
    call.Note(TokenLog("issued", token) + fmt::format(" uses={} lifetime_s={}", token.uses_left, lifetime));
    call.Apply([=](CoreContext& core) {
      const auto issued = core.farm.membership().IssueToken(token);
      return issued ? grpc::Status::OK : ToStatus(issued.error());
    });
  });
}

grpc::ServerUnaryReactor* AccessService::ListAccess(grpc::CallbackServerContext* context,
                                                    const proto::AccessRequest*,
                                                    proto::AccessAnswer* answer) {
  return gate_.Unary(context, RuleFor("Access.ListAccess"), [=](const UnaryCall& call) {
    call.Ask([=](CoreContext& core) {
      const MembershipLedger& ledger = core.farm.membership();
      for (const auto& [key, token] : ledger.tokens()) Write(token, *answer->add_tokens());
      for (const auto& [id, member] : ledger.members()) Write(member, *answer->add_members());
      return grpc::Status::OK;
    });
  });
}

grpc::ServerUnaryReactor* AccessService::Revoke(grpc::CallbackServerContext* context,
                                                const proto::RevokeRequest* request,
                                                proto::AccessAnswer* answer) {
  return gate_.Unary(context, RuleFor("Access.Revoke"), [=](const UnaryCall& call) {
    const std::string which = CleanName(request->which());
    call.Note("which=" + LogText(which));
    call.Apply([=](CoreContext& core) {
      RevokeAll(core.farm.membership(), which, *answer);
      if (answer->members_size() + answer->tokens_size() > 0) return grpc::Status::OK;
      return grpc::Status(
          grpc::StatusCode::NOT_FOUND,
          fmt::format("there is no member or token \"{}\"; run `tessera access` to list them", which));
    });
  });
}

}  // namespace tessera
