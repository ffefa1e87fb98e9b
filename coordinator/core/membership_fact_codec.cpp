#include "coordinator/core/membership_fact_codec.h"

#include "coordinator/core/membership_codec.h"

namespace tessera {

void Add(ByteWriter& out, const TokenIssued& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kTokenIssued));
  AddToken(out, fact.token);
}

void Add(ByteWriter& out, const TokenRevoked& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kTokenRevoked));
  AddDigest(out, fact.key);
}

void Add(ByteWriter& out, const MemberJoined& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kMemberJoined));
  AddMember(out, fact.member);
}

void Add(ByteWriter& out, const MemberRenewed& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kMemberRenewed));
  out.Add64(Number(fact.id));
  out.Add64(static_cast<uint64_t>(fact.expires));
}

void Add(ByteWriter& out, const MemberRevoked& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kMemberRevoked));
  out.Add64(Number(fact.id));
}

void Add(ByteWriter& out, const AuthorityChosen& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kAuthorityChosen));
  AddDigest(out, fact.fingerprint);
}

std::optional<Fact> ReadMembershipFact(FactKind kind, ByteReader& in) {
  switch (kind) {
    case FactKind::kTokenIssued: {
      TokenIssued fact;
      return ReadToken(in, fact.token) ? std::optional<Fact>(std::move(fact)) : std::nullopt;
    }
    case FactKind::kTokenRevoked: {
      TokenRevoked fact;
      return ReadDigest(in, fact.key) ? std::optional<Fact>(fact) : std::nullopt;
    }
    case FactKind::kMemberJoined: {
      MemberJoined fact;
      return ReadMember(in, fact.member) ? std::optional<Fact>(std::move(fact)) : std::nullopt;
    }
    case FactKind::kMemberRenewed: {
      const MemberId id{in.Read64()};
      return MemberRenewed{id, static_cast<UnixTime>(in.Read64())};
    }
    case FactKind::kMemberRevoked: return MemberRevoked{MemberId{in.Read64()}};
    case FactKind::kAuthorityChosen: {
      AuthorityChosen fact;
      return ReadDigest(in, fact.fingerprint) ? std::optional<Fact>(fact) : std::nullopt;
    }
    default: return std::nullopt;
  }
}

}  // namespace tessera
