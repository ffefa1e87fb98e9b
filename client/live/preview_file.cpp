#include "client/live/preview_file.h"

#include <fmt/format.h>

#include "client/output/files_in_use.h"
#include "client/output/output_file.h"
#include "client/output/output_target.h"
#include "client/output/picture_encoder.h"
#include "client/output/picture_format.h"

namespace tessera {

Result<void> PreviewFile::Show(const LivePicture& picture, const std::stop_token& stop) {
  const auto format = PictureFormatOf(path_);
  if (!format) return format.error();
  const auto bytes = EncodeAs(*format, picture.picture, path_);
  if (!bytes) return bytes.error();
  return WriteOutput(path_, *bytes, stop);
}

Result<void> CheckPreview(const std::string& path, const std::set<std::string>& inputs,
                          const std::vector<std::string>& outputs) {
  const auto format = PictureFormatOf(path);
  const bool is_image = format && (*format == PictureFormat::kPng || *format == PictureFormat::kJpeg);
  if (!is_image) return BadInput(fmt::format("--preview {}: the name must end in .png or .jpg", path));
  if (auto can_encode = CheckEncoder(*format); !can_encode) return can_encode;
  const auto target = ExamineOutput(path);
  if (!target) return {};  // a warning follows when it is written
  if (target->kind == OutputTarget::Kind::kStream || target->kind == OutputTarget::Kind::kDescriptor)
    return BadInput(fmt::format("--preview {}: is no file that can be replaced", path));
  FilesInUse files;
  for (const std::string& input : inputs) files.AddInput(input);
  for (const std::string& output : outputs) {
    if (auto added = files.AddOutput(output); !added) return added;
  }
  return files.AddOutput(path);
}

}  // namespace tessera
