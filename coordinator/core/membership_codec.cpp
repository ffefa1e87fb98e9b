#include "coordinator/core/membership_codec.h"

#include "coordinator/core/job_codec.h"

namespace tessera {
namespace {

// Their numbers never change.
constexpr std::pair<Role, uint32_t> kRoleNumbers[] = {
    {Role::kWorker, 1}, {Role::kUser, 2}, {Role::kViewer, 3}, {Role::kOperator, 4}};

void AddRole(ByteWriter& out, Role role) {
  for (const auto& [each, number] : kRoleNumbers) {
    if (each == role) out.Add32(number);
  }
}

bool ReadRole(ByteReader& in, Role& role) {
  const uint32_t read = in.Read32();
  for (const auto& [each, number] : kRoleNumbers) {
    if (number != read) continue;
    role = each;
    return true;
  }
  return false;
}

UnixTime ReadTime(ByteReader& in) {
  return static_cast<UnixTime>(in.Read64());
}

}  // namespace

void AddToken(ByteWriter& out, const TokenStatus& token) {
  AddDigest(out, token.key);
  AddRole(out, token.role);
  out.AddText(token.name);
  out.Add64(static_cast<uint64_t>(token.issued));
  out.Add64(static_cast<uint64_t>(token.expires));
  out.Add32(token.uses_left);
}

bool ReadToken(ByteReader& in, TokenStatus& token) {
  if (!ReadDigest(in, token.key) || !ReadRole(in, token.role)) return false;
  token.name = in.ReadText();
  token.issued = ReadTime(in);
  token.expires = ReadTime(in);
  token.uses_left = in.Read32();
  return true;
}

void AddMember(ByteWriter& out, const MemberStatus& member) {
  out.Add64(Number(member.id));
  AddRole(out, member.role);
  out.AddText(member.name);
  out.Add64(static_cast<uint64_t>(member.joined));
  out.Add64(static_cast<uint64_t>(member.expires));
  AddDigest(out, member.token);
}

bool ReadMember(ByteReader& in, MemberStatus& member) {
  member.id = MemberId{in.Read64()};
  if (Number(member.id) == 0 || !ReadRole(in, member.role)) return false;
  member.name = in.ReadText();
  member.joined = ReadTime(in);
  member.expires = ReadTime(in);
  return ReadDigest(in, member.token);
}

}  // namespace tessera
