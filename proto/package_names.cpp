#include "terms/package_names.h"

#include <fmt/format.h>

#include "terms/scene_package.h"

namespace tessera {
namespace {

constexpr std::string_view kEncodedFolder = "names/";

bool IsPlain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}

}  // namespace

std::string PackagePath(std::string_view name) {
  if (IsPackagePath(name) && !name.starts_with(kEncodedFolder)) return std::string(name);
  std::string path(kEncodedFolder);
  for (char c : name) path += IsPlain(c) ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return IsPackagePath(path) ? path : std::string();
}

}  // namespace tessera
