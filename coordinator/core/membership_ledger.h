// The members of a farm and the tokens with which they join. Pure: times come in as arguments, facts go out.
// Not thread safe: part of the farm.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/core/fact.h"
#include "proto/membership.h"
#include "renderer/util/result.h"

namespace tessera {

// A token and a member take some 300 bytes of memory. Members: as many as a farm has workers, and people.
constexpr size_t kTokensMax = 10'000;
constexpr size_t kMembersMax = 200'000;
constexpr uint32_t kTokenUsesMax = 100'000;  // the workers of the largest farm
// How long tokens that cannot be used and members that cannot return stay listed, so that whoever tries
// learns why.
constexpr UnixTime kForgetAfter_s = 30 * 24 * 3600;

// Why a token cannot be used, or empty; and the error for whoever tried.
std::string WhyUnusable(UnixTime now, const TokenStatus& token);
Error UnusableToken(const std::string& why);

class MembershipLedger {
 public:
  // `facts` receives what happened; it must outlive the ledger.
  explicit MembershipLedger(std::vector<Fact>& facts) : facts_(facts) {}

  // ---- After a start: all facts of former processes, in order ----
  void Restore(const TokenIssued& fact);
  void Restore(const TokenRevoked& fact);
  void Restore(const MemberJoined& fact);
  void Restore(const MemberRenewed& fact);
  void Restore(const MemberRevoked& fact);
  void Restore(const AuthorityChosen& fact) { authority_ = fact.fingerprint; }
  // Facts that lead to the present state.
  void AppendSnapshot(std::vector<Fact>& facts) const;

  // ---- Changes. The errors are for whoever asked ----
  Result<void> IssueToken(const TokenStatus& token);
  // Somebody who has shown the key of a token becomes a member. Counts as one use.
  Result<void> Join(UnixTime now, const MemberStatus& member);
  // The holder of a certificate of an organisation becomes a member, or has a later certificate. Does nothing
  // if that is known.
  Result<void> Enrol(UnixTime now, const MemberStatus& member);
  // The member never got its certificate: it is revoked, and its token has its use back.
  void UndoJoin(MemberId id);
  // The member has a certificate until `expires`.
  Result<void> Renew(UnixTime now, MemberId id, UnixTime expires);
  // Return false if there is none, or if it was revoked already.
  bool RevokeToken(const Digest& key);
  bool RevokeMember(MemberId id);

  // Records the fingerprint of the farm's authority. Does nothing if it is recorded already.
  void ChooseAuthority(const Digest& fingerprint);
  // Returns nullopt if it is not known: the farm has never had one, or had it before it was recorded.
  const std::optional<Digest>& authority() const { return authority_; }

  // Why the token cannot be used, or empty.
  std::string WhyUnusable(UnixTime now, const Digest& key) const;
  const std::map<Digest, TokenStatus>& tokens() const { return tokens_; }
  const std::map<MemberId, MemberStatus>& members() const { return members_; }

 private:
  void Forget(UnixTime now);

  std::vector<Fact>& facts_;
  std::optional<Digest> authority_;
  std::map<Digest, TokenStatus> tokens_;
  std::map<MemberId, MemberStatus> members_;
};

}  // namespace tessera
