// The bytes of facts about members and tokens, as members of a fact (fact.h).
#pragma once

#include "coordinator/core/byte_codec.h"
#include "proto/membership.h"

namespace tessera {

// Return false if the bytes are not what was added.
void AddToken(ByteWriter& out, const TokenStatus& token);
bool ReadToken(ByteReader& in, TokenStatus& token);
void AddMember(ByteWriter& out, const MemberStatus& member);
bool ReadMember(ByteReader& in, MemberStatus& member);

}  // namespace tessera
