// Facts about members, tokens and the authority as bytes of a journal (EncodeFact).
#pragma once

#include <optional>

#include "coordinator/core/byte_codec.h"
#include "coordinator/core/fact.h"
#include "coordinator/core/fact_kind.h"

namespace tessera {

void Add(ByteWriter& out, const TokenIssued& fact);
void Add(ByteWriter& out, const TokenRevoked& fact);
void Add(ByteWriter& out, const MemberJoined& fact);
void Add(ByteWriter& out, const MemberRenewed& fact);
void Add(ByteWriter& out, const MemberRevoked& fact);
void Add(ByteWriter& out, const AuthorityChosen& fact);

// Reads what follows the kind. Returns nullopt for other kinds and for what Add does not write.
std::optional<Fact> ReadMembershipFact(FactKind kind, ByteReader& in);

}  // namespace tessera
