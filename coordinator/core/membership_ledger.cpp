#include "coordinator/core/membership_ledger.h"

#include <fmt/format.h>

namespace tessera {
namespace {

bool IsDead(const TokenStatus& token) {
  return token.revoked || token.uses_left == 0;
}

}  // namespace

Error UnusableToken(const std::string& why) {
  return Failed(why + "; ask an operator of the farm for another");
}

std::string WhyUnusable(UnixTime now, const TokenStatus& token) {
  if (token.revoked) return "the token was revoked";
  if (token.uses_left == 0) return "the token has been used up";
  if (token.expires <= now) return "the token has expired";
  return {};
}

void MembershipLedger::Restore(const TokenIssued& fact) {
  tokens_[fact.token.key] = fact.token;
}

void MembershipLedger::Restore(const TokenRevoked& fact) {
  const auto found = tokens_.find(fact.key);
  if (found != tokens_.end()) found->second.revoked = true;
}

void MembershipLedger::Restore(const MemberJoined& fact) {
  members_[fact.member.id] = fact.member;
  const auto token = tokens_.find(fact.member.token);
  if (token != tokens_.end() && token->second.uses_left > 0) --token->second.uses_left;
}

void MembershipLedger::Restore(const MemberRenewed& fact) {
  const auto found = members_.find(fact.id);
  if (found != members_.end()) found->second.expires = fact.expires;
}

void MembershipLedger::Restore(const MemberRevoked& fact) {
  const auto found = members_.find(fact.id);
  if (found != members_.end()) found->second.revoked = true;
}

// Members come first: a token holds the uses that were left after they joined.
void MembershipLedger::AppendSnapshot(std::vector<Fact>& facts) const {
  if (authority_) facts.emplace_back(AuthorityChosen{*authority_});
  for (const auto& [id, member] : members_) {
    MemberStatus joined = member;
    joined.revoked = false;
    facts.emplace_back(MemberJoined{std::move(joined)});
    if (member.revoked) facts.emplace_back(MemberRevoked{id});
  }
  for (const auto& [key, token] : tokens_) {
    TokenStatus issued = token;
    issued.revoked = false;
    facts.emplace_back(TokenIssued{std::move(issued)});
    if (token.revoked) facts.emplace_back(TokenRevoked{key});
  }
}

void MembershipLedger::ChooseAuthority(const Digest& fingerprint) {
  if (authority_ == fingerprint) return;
  facts_.emplace_back(AuthorityChosen{fingerprint});
  authority_ = fingerprint;
}

Result<void> MembershipLedger::IssueToken(const TokenStatus& token) {
  Forget(token.issued);
  if (tokens_.size() >= kTokensMax)
    return Failed(fmt::format("there are {} tokens, which is the limit; revoke some", kTokensMax));
  if (token.uses_left < 1 || token.uses_left > kTokenUsesMax || token.expires <= token.issued)
    return BadInput("message refused: uses or time to live are out of range");
  if (tokens_.contains(token.key)) return Failed("there is a token with this key already");
  facts_.emplace_back(TokenIssued{token});
  tokens_.emplace(token.key, token);
  return {};
}

std::string MembershipLedger::WhyUnusable(UnixTime now, const Digest& key) const {
  const auto found = tokens_.find(key);
  return found != tokens_.end() ? tessera::WhyUnusable(now, found->second)
                                : "this farm does not know the token";
}

Result<void> MembershipLedger::Join(UnixTime now, const MemberStatus& member) {
  if (const std::string why = WhyUnusable(now, member.token); !why.empty()) return UnusableToken(why);
  Forget(now);
  if (members_.size() >= kMembersMax)
    return Failed(fmt::format("the farm has {} members, which is its limit; revoke some", kMembersMax));
  if (members_.contains(member.id)) return Failed("the number of the new member is taken; join again");
  facts_.emplace_back(MemberJoined{member});
  Restore(MemberJoined{member});
  return {};
}

Result<void> MembershipLedger::Enrol(UnixTime now, const MemberStatus& member) {
  const auto known = members_.find(member.id);
  if (known == members_.end()) {
    Forget(now);
    if (members_.size() >= kMembersMax)
      return Failed(fmt::format("the farm has {} members, which is its limit", kMembersMax));
    facts_.emplace_back(MemberJoined{member});
    members_.emplace(member.id, member);
  } else if (!known->second.revoked && known->second.expires < member.expires) {
    facts_.emplace_back(MemberRenewed{member.id, member.expires});
    known->second.expires = member.expires;
  }
  return {};
}

void MembershipLedger::UndoJoin(MemberId id) {
  if (!RevokeMember(id)) return;
  const auto token = tokens_.find(members_.at(id).token);
  if (token == tokens_.end()) return;
  ++token->second.uses_left;
  TokenStatus issued = token->second;
  issued.revoked = false;
  facts_.emplace_back(TokenIssued{std::move(issued)});
  if (token->second.revoked) facts_.emplace_back(TokenRevoked{token->first});
}

Result<void> MembershipLedger::Renew(UnixTime now, MemberId id, UnixTime expires) {
  const auto found = members_.find(id);
  if (found == members_.end() || found->second.revoked)
    return Failed("the certificate was revoked; ask an operator of the farm for a token");
  if (found->second.expires <= now)
    return Failed("the certificate has expired; ask an operator of the farm for a token");
  facts_.emplace_back(MemberRenewed{id, expires});
  found->second.expires = expires;
  return {};
}

bool MembershipLedger::RevokeToken(const Digest& key) {
  const auto found = tokens_.find(key);
  if (found == tokens_.end() || found->second.revoked) return false;
  facts_.emplace_back(TokenRevoked{key});
  found->second.revoked = true;
  return true;
}

bool MembershipLedger::RevokeMember(MemberId id) {
  const auto found = members_.find(id);
  if (found == members_.end() || found->second.revoked) return false;
  facts_.emplace_back(MemberRevoked{id});
  found->second.revoked = true;
  return true;
}

// Needs no facts: what a later process restores of them it forgets again. A member whose last certificate has
// expired long ago cannot come back with it, revoked or not; but an organisation may issue another for the
// same member. One that was revoked makes room when there is no other: whoever is not known is refused as
// well.
void MembershipLedger::Forget(UnixTime now) {
  const bool are_full = members_.size() >= kMembersMax;
  std::erase_if(members_, [&](const auto& each) {
    const MemberStatus& member = each.second;
    const bool may_return = member.IsOfOrganisation() && member.revoked;
    const bool is_unneeded = member.expires + kForgetAfter_s < now || (member.revoked && are_full);
    return is_unneeded && !may_return;
  });
  std::erase_if(tokens_, [&](const auto& each) {
    const TokenStatus& token = each.second;
    return token.expires + kForgetAfter_s < now || (IsDead(token) && tokens_.size() >= kTokensMax);
  });
}

}  // namespace tessera
