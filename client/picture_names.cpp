#include "client/picture_names.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

namespace tessera {
namespace {

Result<void> CheckFile(const std::string& path) {
  const std::filesystem::path file(path);
  const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    return BadInput(fmt::format("{}: the folder {} does not exist", path, folder));
  }
  if (std::filesystem::is_directory(file, error)) return BadInput(fmt::format("{}: is a folder", path));
  if (::access(folder.c_str(), W_OK) != 0) {
    return BadInput(fmt::format("{}: no permission to write to the folder {}", path, folder));
  }
  return {};
}

FrameName NameWith(const std::string& text, PictureNames::Numbers numbers) {
  const FrameName name(text);
  return numbers == PictureNames::Numbers::kAlways && !name.empty() ? name.WithPlace() : name;
}

}  // namespace

PictureNames::PictureNames(const std::string& exr, const std::string& png, Numbers numbers)
    : exr_(NameWith(exr, numbers)), png_(NameWith(png, numbers)), numbers_(numbers) {}

std::string PictureNames::NameOf(const FrameName& name, int frame) const {
  return numbers_ == Numbers::kNone ? name.text() : name.Of(frame);
}

Result<void> PictureNames::CheckWritable(const std::vector<int>& frames) const {
  for (const int frame : frames) {
    if (auto writable = CheckFile(Exr(frame)); !writable) return writable;
    if (png_.empty()) continue;
    if (auto writable = CheckFile(Png(frame)); !writable) return writable;
  }
  return {};
}

}  // namespace tessera
