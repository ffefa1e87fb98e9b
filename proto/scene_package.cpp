#include "proto/scene_package.h"

#include <fmt/format.h>

#include <charconv>

#include "proto/terms.h"

namespace tessera {
namespace {

constexpr std::string_view kFirstLine = "tessera-package 1";

// The text up to the next newline, which is taken off `rest` with it; nothing if there is none.
std::optional<std::string_view> TakeLine(std::string_view& rest) {
  const size_t end = rest.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  return line;
}

// What is wrong with the line, or nullptr.
const char* ParseFileLine(std::string_view line, std::string_view& path, PackageFile& file) {
  constexpr size_t kHexDigits = 64;
  if (line.size() < kHexDigits + 2 || line[kHexDigits] != ' ') return "expected: digest, size, path";
  const auto digest = Digest::FromHex(line.substr(0, kHexDigits));
  if (!digest) return "the digest is not 64 hexadecimal digits";
  file.digest = *digest;
  const char* const number = line.data() + kHexDigits + 1;
  const auto [end, error] = std::from_chars(number, line.data() + line.size(), file.size);
  if (error != std::errc() || end == line.data() + line.size() || *end != ' ')
    return "expected a size after the digest";
  if (file.size > kBlobBytesMax) return "the size is beyond the limit";
  path = line.substr(static_cast<size_t>(end + 1 - line.data()));
  if (!IsPackagePath(path)) return "the path is not inside the package";
  return nullptr;
}

}  // namespace

bool IsPackagePath(std::string_view path) {
  if (path.empty() || path.size() > kPathBytesMax) return false;
  for (const char c : path) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\') return false;
  }
  while (true) {
    const size_t slash = path.find('/');
    const std::string_view part = path.substr(0, slash);
    if (part.empty() || part == "." || part == "..") return false;
    if (slash == std::string_view::npos) return true;
    path.remove_prefix(slash + 1);
  }
}

std::string EncodeScenePackage(const ScenePackage& package) {
  std::string text = fmt::format("{}\n", kFirstLine);
  for (const auto& [path, file] : package.files) {
    text += fmt::format("{} {} {}\n", file.digest.Hex(), file.size, path);
  }
  return text;
}

Result<ScenePackage> DecodeScenePackage(std::string_view manifest) {
  if (manifest.size() > kManifestBytesMax) return BadInput("the scene package's manifest is too large");
  std::string_view rest = manifest;
  if (TakeLine(rest) != kFirstLine) return BadInput(fmt::format("manifest:1: expected \"{}\"", kFirstLine));
  ScenePackage package;
  for (int number = 2; !rest.empty(); ++number) {
    const auto line = TakeLine(rest);
    if (!line) return BadInput(fmt::format("manifest:{}: truncated", number));
    std::string_view path;
    PackageFile file;
    if (const char* const wrong = ParseFileLine(*line, path, file)) {
      return BadInput(fmt::format("manifest:{}: {}", number, wrong));
    }
    if (package.files.size() == kFilesPerPackageMax) {
      return BadInput(fmt::format("manifest:{}: more than {} files", number, kFilesPerPackageMax));
    }
    package.files.emplace(path, file);
  }
  // Upper-case digits, files out of order or twice, numbers with leading zeros: not our bytes.
  if (EncodeScenePackage(package) != manifest) return BadInput("manifest: not in canonical form");
  return package;
}

}  // namespace tessera
