// Who a certificate stands for, as the URI in it.
//   tessera:ROLE/ID     a member of the farm (MemberId), with a certificate of the farm's own authority
//   tessera:ROLE/NAME   a member with a certificate of an organisation
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
  MemberId id{};             // of a member; made of role and name in certificates of an organisation
  std::string name;          // in certificates of an organisation
  Digest token_key{};        // of the holder of a token

  bool IsMember() const { return role.has_value(); }
  bool IsOfOrganisation() const { return !name.empty(); }
  bool operator==(const Subject&) const = default;
  std::string Uri() const;
  // Returns nullopt if the text is no such URI.
  static std::optional<Subject> Parse(std::string_view uri);
};

// A member with a certificate of an organisation.
Subject SubjectOfOrganisation(Role role, const std::string& name);
// Whether a certificate of an organisation may call its holder this: letters, digits and ". _ - @", at most
// 64, and not 16 hexadecimal digits, which are an id.
bool IsMemberName(std::string_view name);

// 16 hexadecimal digits. Those of a token are the first of its key's digest.
std::string MemberIdText(MemberId id);
std::string TokenIdText(const Digest& key);
std::optional<MemberId> ParseMemberId(std::string_view text);

// A name in the certificate of every coordinator. Clients of a farm trust its own authority alone, so they
// check this name instead of the address, which may change or lead through a tunnel.
constexpr const char* kCoordinatorName = "coordinator.tessera.internal";

}  // namespace tessera
