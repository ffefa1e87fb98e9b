#include "client/output/files_in_use.h"

#include <fmt/format.h>

namespace tessera {

void FilesInUse::AddInput(const std::string& path) {
  // An input that no longer exists cannot be overwritten.
  if (const auto identity = IdentityOfInput(path)) uses_.insert({*identity, {path, true}});
}

Result<void> FilesInUse::AddOutput(const std::string& path) {
  const auto target = ExamineOutput(path);
  if (!target) return target.error();
  if (S_ISCHR(target->status.st_mode)) return {};
  const auto [use, is_new] = uses_.insert({target->identity, {path, false}});
  if (is_new) return {};
  const std::string& other = use->second.path;
  const std::string alias = path == other ? "" : fmt::format(" ({})", ShownPath(other));
  if (use->second.is_input)
    return BadInput(
        fmt::format("{}: the command reads this file{}, so nothing can be written to it; choose another name",
                    ShownPath(path), alias));
  return BadInput(fmt::format("{}: two pictures would be written to this file{}; choose another name",
                              ShownPath(path), alias));
}

}  // namespace tessera
