// The sessions of people who have logged in with a browser. Kept in memory alone: a restart ends them. Pure:
// times come in as arguments. Not thread safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "proto/membership.h"
#include "renderer/util/digest.h"

namespace tessera {

// A session ends after a working day, and earlier if its browser asks for nothing.
constexpr std::chrono::hours kSessionLifetime{12};
constexpr std::chrono::hours kSessionIdleMax{1};
constexpr size_t kSessionsMax = 1000;  // some 200 bytes each

class SessionTable {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  // Returns the secret of the new session, of which only the digest is kept. Ends the session that was unused
  // for longest if there are kSessionsMax.
  std::string Open(MemberId member, TimePoint now);
  // Whose session it is, which counts as a use. Returns nullopt if there is none or it has ended.
  std::optional<MemberId> Use(std::string_view secret, TimePoint now);
  // Whether it could be used, which this does not count as.
  bool IsOpen(std::string_view secret, TimePoint now) const;
  void End(std::string_view secret);
  size_t size() const { return sessions_.size(); }

 private:
  struct Session {
    MemberId member{};
    TimePoint opened{}, used{};
    bool HasEnded(TimePoint now) const {
      return now - opened >= kSessionLifetime || now - used >= kSessionIdleMax;
    }
  };
  // By the digest of the secret: how long the search takes tells nothing about the secret.
  std::map<Digest, Session> sessions_;
};

}  // namespace tessera
