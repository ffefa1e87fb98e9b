#include "proto/identity/subject.h"

#include <fmt/format.h>

#include <charconv>
#include <cstring>

namespace tessera {
namespace {

constexpr std::string_view kScheme = "tessera:";
constexpr std::string_view kToken = "token";
constexpr size_t kIdDigits = 16;
constexpr size_t kMemberNameMax = 64;

}  // namespace

std::string MemberIdText(MemberId id) {
  return fmt::format("{:016x}", Number(id));
}

std::string TokenIdText(const Digest& key) {
  return key.Hex().substr(0, kIdDigits);
}

std::optional<MemberId> ParseMemberId(std::string_view text) {
  uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, 16);
  if (text.size() != kIdDigits || error != std::errc() || end != text.data() + text.size() || number == 0)
    return std::nullopt;
  return MemberId{number};
}

bool IsMemberName(std::string_view name) {
  constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-@";
  constexpr std::string_view kHex = "0123456789abcdefABCDEF";
  return !name.empty() && name.size() <= kMemberNameMax &&
         name.find_first_not_of(kAllowed) == std::string_view::npos &&
         !(name.size() == kIdDigits && name.find_first_not_of(kHex) == std::string_view::npos);
}

Subject SubjectOfOrganisation(Role role, const std::string& name) {
  Subject subject;
  subject.role = role;
  subject.name = name;
  const Digest digest = Sha256(subject.Uri());
  uint64_t number = 0;
  std::memcpy(&number, digest.bytes.data(), sizeof number);
  subject.id = MemberId{number != 0 ? number : 1};
  return subject;
}

std::string Subject::Uri() const {
  if (IsOfOrganisation()) return fmt::format("{}{}/{}", kScheme, RoleName(*role), name);
  if (IsMember()) return fmt::format("{}{}/{}", kScheme, RoleName(*role), MemberIdText(id));
  return fmt::format("{}{}/{}", kScheme, kToken, token_key.Hex());
}

std::optional<Subject> Subject::Parse(std::string_view uri) {
  if (!uri.starts_with(kScheme)) return std::nullopt;
  uri.remove_prefix(kScheme.size());
  const size_t slash = uri.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const std::string_view kind = uri.substr(0, slash), rest = uri.substr(slash + 1);
  Subject subject;
  if (kind == kToken) {
    const auto key = Digest::FromHex(rest);
    if (!key) return std::nullopt;
    subject.token_key = *key;
    return subject;
  }
  subject.role = FindRole(kind);
  if (subject.role && IsMemberName(rest)) return SubjectOfOrganisation(*subject.role, std::string(rest));
  const auto id = ParseMemberId(rest);
  if (!subject.role || !id) return std::nullopt;
  subject.id = *id;
  return subject;
}

}  // namespace tessera
