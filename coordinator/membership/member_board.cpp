#include "coordinator/membership/member_board.h"

#include <mutex>
#include <variant>

namespace tessera {

void MemberBoard::Set(const MembershipLedger& ledger) {
  const std::unique_lock lock(mutex_);
  authority_ = ledger.authority();
  members_ = ledger.members();
  tokens_ = ledger.tokens();
}

void MemberBoard::Note(const Fact& fact) {
  const auto change_member = [this](MemberId id, const auto& change) {
    const std::unique_lock lock(mutex_);
    const auto found = members_.find(id);
    if (found != members_.end()) change(found->second);
  };
  if (const auto* joined = std::get_if<MemberJoined>(&fact)) {
    const std::unique_lock lock(mutex_);
    members_[joined->member.id] = joined->member;
    const auto token = tokens_.find(joined->member.token);
    if (token != tokens_.end() && token->second.uses_left > 0) --token->second.uses_left;
  } else if (const auto* renewed = std::get_if<MemberRenewed>(&fact)) {
    change_member(renewed->id, [&](MemberStatus& member) { member.expires = renewed->expires; });
  } else if (const auto* revoked = std::get_if<MemberRevoked>(&fact)) {
    change_member(revoked->id, [](MemberStatus& member) { member.revoked = true; });
    ++revocations_;
  } else if (const auto* issued = std::get_if<TokenIssued>(&fact)) {
    const std::unique_lock lock(mutex_);
    tokens_[issued->token.key] = issued->token;
  } else if (const auto* ended = std::get_if<TokenRevoked>(&fact)) {
    const std::unique_lock lock(mutex_);
    const auto token = tokens_.find(ended->key);
    if (token != tokens_.end()) token->second.revoked = true;
  } else if (const auto* chosen = std::get_if<AuthorityChosen>(&fact)) {
    const std::unique_lock lock(mutex_);
    authority_ = chosen->fingerprint;
  }
}

std::optional<Digest> MemberBoard::authority() const {
  const std::shared_lock lock(mutex_);
  return authority_;
}

bool MemberBoard::HasMembers() const {
  const std::shared_lock lock(mutex_);
  return !members_.empty();
}

std::optional<MemberStatus> MemberBoard::FindMember(MemberId id) const {
  const std::shared_lock lock(mutex_);
  const auto found = members_.find(id);
  return found != members_.end() ? std::optional(found->second) : std::nullopt;
}

std::optional<TokenStatus> MemberBoard::FindToken(const Digest& key) const {
  const std::shared_lock lock(mutex_);
  const auto found = tokens_.find(key);
  return found != tokens_.end() ? std::optional(found->second) : std::nullopt;
}

}  // namespace tessera
