#include "coordinator/page/page_files.h"

#include <cstddef>
#include <functional>
#include <map>

#include "coordinator/page/embedded_file.h"
#include "renderer/util/digest.h"

namespace tessera {
namespace {

std::string TypeOf(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".svg")) return "image/svg+xml";
  if (name.ends_with(".json")) return "application/json";
  return "text/javascript; charset=utf-8";
}

using Files = std::map<std::string, PageFile, std::less<>>;

Files AllFiles() {
  Files files;
  for (const EmbeddedFile& file : EmbeddedFiles()) {
    const std::string name = file.name;
    auto bytes = std::make_shared<const std::string>(reinterpret_cast<const char*>(file.bytes), file.size);
    const std::string etag = '"' + Sha256(std::string_view(*bytes)).Hex().substr(0, 32) + '"';
    const bool is_page = name == "index.html";
    files[is_page ? "/" : "/page/" + name] = {TypeOf(name), etag, is_page, std::move(bytes)};
  }
  return files;
}

}  // namespace

const PageFile* FindPageFile(std::string_view path) {
  static const Files kFiles = AllFiles();
  const auto found = kFiles.find(path);
  return found != kFiles.end() ? &found->second : nullptr;
}

}  // namespace tessera
