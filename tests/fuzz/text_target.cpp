#include <algorithm>
#include <cctype>

#include "coordinator/web/form.h"
#include "coordinator/web/http_request.h"
#include "proto/identity/join_token.h"
#include "proto/identity/subject.h"
#include "proto/package_names.h"
#include "proto/scene_package.h"
#include "renderer/scene/scene.h"
#include "renderer/text/unicode.h"
#include "renderer/util/check.h"
#include "tests/fuzz/targets.h"

namespace tessera {
namespace {

void CheckCleaned(std::string_view text, size_t bytes_max) {
  const std::string clean = CleanText(text, bytes_max);
  TESSERA_CHECK(clean.size() <= bytes_max && IsUtf8(clean));
  TESSERA_CHECK(CleanText(clean, bytes_max) == clean);
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  TESSERA_CHECK(std::ranges::none_of(clean, is_control));
}

void CheckLogText(std::string_view text) {
  const std::string quoted = LogText(text);
  TESSERA_CHECK(quoted.size() >= 2 && quoted.front() == '"' && quoted.back() == '"');
  bool is_escaped = false;
  for (size_t i = 1; i + 1 < quoted.size(); ++i) {
    TESSERA_CHECK(is_escaped || quoted[i] != '"');
    is_escaped = !is_escaped && quoted[i] == '\\';
  }
  TESSERA_CHECK(!is_escaped);
}

void CheckPackagePath(const std::string& name) {
  const std::string path = PackagePath(name);
  if (path.empty()) return;
  TESSERA_CHECK(IsPackagePath(path) && IsUtf8(path));
  TESSERA_CHECK(NameOfPackagePath(path) == name);
}

}  // namespace

// The first byte is a limit for the text in the others.
bool FuzzText(std::string_view bytes) {
  if (bytes.empty()) return false;
  const std::string_view text = bytes.substr(1);
  CheckCleaned(text, static_cast<unsigned char>(bytes.front()));
  CheckCleaned(text, text.size());
  CheckLogText(text);
  const std::string normal = Normalize(text);
  TESSERA_CHECK(Normalize(normal) == normal && IsUtf8(normal) == IsUtf8(text));
  CheckPackagePath(std::string(text));
  NameOfPackagePath(text);
  PackageFolder(text);
  return IsUtf8(text);
}

bool FuzzManifest(std::string_view bytes) {
  const Result<ScenePackage> package = DecodeScenePackage(bytes);
  TESSERA_CHECK(!package || EncodeScenePackage(*package) == bytes);
  return package.has_value();
}

bool FuzzRenderOptions(std::string_view bytes) {
  const Result<RenderOptions> options = DecodeRenderOptions(std::string(bytes));
  if (!options) return false;
  const Result<RenderOptions> again = DecodeRenderOptions(EncodeRenderOptions(*options));
  TESSERA_CHECK(again.has_value() && *again == *options);
  return true;
}

bool FuzzHttpRequest(std::string_view bytes) {
  const std::optional<HttpRequest> request = ParseHttpRequest(bytes);
  if (!request) return false;
  TESSERA_CHECK(request->path.starts_with('/') && request->path.find('?') == std::string::npos);
  TESSERA_CHECK(std::ranges::none_of(request->host, [](unsigned char c) { return std::isupper(c); }));
  for (const std::string& text : {request->method, request->path, request->query, request->authority,
                                  request->host, request->origin, request->cookies})
    TESSERA_CHECK(text.find("\r\n") == std::string::npos);
  TESSERA_CHECK(CookieValue(request->cookies, "session").find(';') == std::string::npos);
  IsOwnHost(request->host, {"Farm.example", "[::1]"});
  return true;
}

bool FuzzWebForm(std::string_view bytes) {
  static_cast<void>(CookieValue(bytes, "session"));
  const auto form = ParseForm(bytes);
  if (!form) return false;
  size_t size = 0;
  for (const auto& [name, value] : *form) size += name.size() + value.size();
  TESSERA_CHECK(form->size() <= kFormFieldsMax && size <= bytes.size());
  return true;
}

// The bytes in a token.
bool FuzzJoinToken(std::string_view bytes) {
  static_cast<void>(JoinToken::Parse(bytes));
  ParseMemberId(bytes);
  if (const auto subject = Subject::Parse(bytes)) TESSERA_CHECK(Subject::Parse(subject->Uri()) == *subject);
  const Result<JoinToken> token = JoinToken::Parse(JoinToken::TextOf(bytes));
  if (!token) {
    TESSERA_CHECK(!token.error().message.empty());
    return false;
  }
  TESSERA_CHECK(token->Text() == JoinToken::TextOf(bytes));
  return true;
}

}  // namespace tessera
