// The members and tokens of a farm for threads that do not own it: those that check certificates and calls.
// Kept up to date by the core thread before it gives the answers that a change causes. Thread safe.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <optional>
#include <shared_mutex>
#include <string>

#include "coordinator/core/fact.h"
#include "coordinator/core/membership_ledger.h"
#include "proto/membership.h"

namespace tessera {

class MemberBoard {
 public:
  // All that the ledger has, at the start.
  void Set(const MembershipLedger& ledger);
  // What has changed since. Ignores facts about other things.
  void Note(const Fact& fact);

  // Of members, so far. Changes whenever one is revoked.
  uint64_t revocations() const { return revocations_; }
  // Of the farm's authority, if it is known.
  std::optional<Digest> authority() const;
  bool HasMembers() const;
  std::optional<MemberStatus> FindMember(MemberId id) const;
  std::optional<TokenStatus> FindToken(const Digest& key) const;

 private:
  std::atomic<uint64_t> revocations_{0};
  mutable std::shared_mutex mutex_;
  std::optional<Digest> authority_;           // guarded by mutex_
  std::map<MemberId, MemberStatus> members_;  // guarded by mutex_
  std::map<Digest, TokenStatus> tokens_;      // guarded by mutex_
};

}  // namespace tessera
