// Who belongs to a farm, as plain values.
#pragma once

#include <cstdint>
#include <string>

#include "proto/roles.h"
#include "renderer/util/digest.h"

namespace tessera {

// Seconds since 1970, UTC. Membership is the only thing that depends on the time of day: it must expire even
// while no program runs.
using UnixTime = int64_t;

// Names a member: a person or a worker machine that has joined. Random, never 0; stays when certificates are
// renewed.
enum class MemberId : uint64_t {};
constexpr uint64_t Number(MemberId id) {
  return static_cast<uint64_t>(id);
}

// A join token as the coordinator keeps it. It cannot be used with what is kept.
struct TokenStatus {
  Digest key{};  // PrivateKey::PublicDigest of its key
  Role role{};
  std::string name;  // of whoever joins with it; empty: they choose
  UnixTime issued = 0, expires = 0;
  uint32_t uses_left = 0;
  bool revoked = false;
  bool operator==(const TokenStatus&) const = default;
};

// Who submitted a job.
struct JobOwner {
  MemberId member{};  // 0: no member
  // As it was then; the member may have been forgotten since. kLocalOwner for whoever used the coordinator's
  // Unix socket; empty for jobs of releases before jobs had owners.
  std::string name;
  bool operator==(const JobOwner&) const = default;
};
constexpr const char* kLocalOwner = "local";

struct MemberStatus {
  MemberId id{};
  Role role{};
  std::string name;
  UnixTime joined = 0, expires = 0;  // expires: of the last certificate
  Digest token{};  // with which the member joined; zeros: the member has a certificate of an organisation
  bool revoked = false;
  bool IsOfOrganisation() const { return token == Digest{}; }
  bool operator==(const MemberStatus&) const = default;
};

}  // namespace tessera
