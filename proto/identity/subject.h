// Who a certificate stands for, as the URI in it.
//   tessera:ROLE/ID     a member of the farm (MemberId)
//   tessera:token/KEY   the holder of a join token; KEY is the digest of the token's key
// The farm is not named: its authority signs for this farm alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "proto/membership.h"
#include "proto/roles.h"
#include "renderer/util/digest.h"

namespace tessera {

struct Subject {
  std::optional<Role> role;  // of a member
  MemberId id{};             // of a member
  Digest token_key{};        // of the holder of a token

  bool IsMember() const { return role.has_value(); }
  bool operator==(const Subject&) const = default;
  std::string Uri() const;
  // Returns nullopt if the text is no such URI.
  static std::optional<Subject> Parse(std::string_view uri);
};

// 16 hexadecimal digits. Those of a token are the first of its key's digest.
std::string MemberIdText(MemberId id);
std::string TokenIdText(const Digest& key);
std::optional<MemberId> ParseMemberId(std::string_view text);

// A name in the certificate of every coordinator. Clients of a farm trust its own authority alone, so they
// check this name instead of the address, which may change or lead through a tunnel.
constexpr const char* kCoordinatorName = "coordinator.tessera.internal";

}  // namespace tessera
