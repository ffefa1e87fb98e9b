#include "client/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "client/png_file.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/file.h"

namespace tessera {

Result<void> CheckWritable(const std::string& path) {
  const std::filesystem::path file(path);
  const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    return BadInput(fmt::format("{}: the folder {} does not exist", path, folder));
  }
  if (std::filesystem::is_directory(file, error)) return BadInput(fmt::format("{}: is a folder", path));
  if (::access(folder.c_str(), W_OK) != 0) {
    return BadInput(fmt::format("{}: the folder {} cannot be written to", path, folder));
  }
  return {};
}

Result<void> WritePicture(std::string_view exr, const std::string& path, const std::string& png) {
  if (auto written = WriteFileAtomically(path, exr); !written) return written;
  if (png.empty()) return {};
  const auto picture = LoadExr(path);
  if (!picture) return picture.error();
  const auto encoded = EncodePng(*picture, png);
  if (!encoded) return encoded.error();
  return WriteFileAtomically(png, *encoded);
}

}  // namespace tessera
