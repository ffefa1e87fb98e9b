#include "proto/package_names.h"

#include <fmt/format.h>

#include <charconv>

#include "proto/scene_package.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr std::string_view kEncodedFolder = "names/";

bool IsPlain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}

}  // namespace

std::string PackagePath(std::string_view name) {
  if (IsPackagePath(name) && IsUtf8(name) && !name.starts_with(kEncodedFolder)) return std::string(name);
  std::string path(kEncodedFolder);
  for (char c : name)
    path += IsPlain(c) ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return IsPackagePath(path) ? path : std::string();
}

std::string NameOfPackagePath(std::string_view path) {
  if (!path.starts_with(kEncodedFolder)) return std::string(path);
  std::string name;
  for (size_t i = kEncodedFolder.size(); i < path.size(); ++i) {
    unsigned char value = 0;
    const char* const digits = path.data() + i + 1;
    if (path[i] == '%' && i + 2 < path.size() &&
        std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      name += static_cast<char>(value);
      i += 2;
    } else {
      name += path[i];
    }
  }
  return PackagePath(name) == path ? name : std::string(path);
}

std::string PackageFolder(std::string_view scene_file) {
  const size_t slash = scene_file.rfind('/');
  std::string_view folder = scene_file.substr(0, slash == std::string_view::npos ? 0 : slash + 1);
  if (folder == kEncodedFolder || folder.ends_with("/" + std::string(kEncodedFolder))) {
    folder.remove_suffix(kEncodedFolder.size());
  }
  return std::string(folder);
}

}  // namespace tessera
