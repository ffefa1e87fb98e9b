#include "coordinator/web/session_table.h"

#include <algorithm>

#include "proto/identity/secrets.h"

namespace tessera {

std::string SessionTable::Open(MemberId member, TimePoint now) {
  if (sessions_.size() >= kSessionsMax)
    std::erase_if(sessions_, [now](const auto& each) { return each.second.HasEnded(now); });
  if (sessions_.size() >= kSessionsMax) {
    const auto last_use = [](const auto& each) { return each.second.used; };
    sessions_.erase(std::ranges::min_element(sessions_, {}, last_use));
  }
  std::string secret = RandomSecret();
  sessions_[Sha256(secret)] = {member, now, now};
  return secret;
}

std::optional<MemberId> SessionTable::Use(std::string_view secret, TimePoint now) {
  const auto found = sessions_.find(Sha256(secret));
  if (found == sessions_.end()) return std::nullopt;
  if (found->second.HasEnded(now)) {
    sessions_.erase(found);
    return std::nullopt;
  }
  found->second.used = now;
  return found->second.member;
}

bool SessionTable::IsOpen(std::string_view secret, TimePoint now) const {
  const auto found = sessions_.find(Sha256(secret));
  return found != sessions_.end() && !found->second.HasEnded(now);
}

void SessionTable::End(std::string_view secret) {
  sessions_.erase(Sha256(secret));
}

}  // namespace tessera
