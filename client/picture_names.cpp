#include "client/picture_names.h"

#include <fmt/format.h>

#include "client/output/files_in_use.h"
#include "client/output/output_target.h"
#include "client/output/picture_encoder.h"
#include "client/output/picture_format.h"

namespace tessera {
namespace {

// Whether the name is that of a device, a pipe or an open file, which is no pattern for names of files.
bool IsStream(const std::string& name) {
  const auto target = ExamineOutput(name);
  return target &&
         (target->kind == OutputTarget::Kind::kStream || target->kind == OutputTarget::Kind::kDescriptor);
}

FrameName NameWith(const std::string& text, PictureNames::Numbers numbers) {
  const FrameName name(text);
  if (numbers != PictureNames::Numbers::kAlways || name.empty() || IsStream(text)) return name;
  return name.WithPlace();
}

// A copy that is called a PNG is one. A device has no ending.
Result<void> CheckPngName(const std::string& name) {
  const auto format = PictureFormatOf(name);
  const bool has_ending = name.substr(name.rfind('/') + 1).find('.') != std::string::npos;
  if (!has_ending || (format && *format == PictureFormat::kPng)) return {};
  return BadInput(fmt::format("--png {}: the name must end in .png; -o writes other formats", name));
}

Result<void> CheckKept(const std::string& path, Existing existing) {
  if (existing == Existing::kReplace || path.empty()) return {};
  const auto target = ExamineOutput(path);
  if (!target || target->kind != OutputTarget::Kind::kRegular) return {};
  return ExistsAlready(path);
}

}  // namespace

PictureNames::PictureNames(const std::string& picture, const std::string& png, Numbers numbers,
                           Existing existing)
    : picture_(NameWith(picture, numbers)),
      png_(NameWith(png, numbers)),
      numbers_(numbers),
      existing_(existing) {}

std::string PictureNames::NameOf(const FrameName& name, int frame) const {
  return numbers_ == Numbers::kNone ? name.text() : name.Of(frame);
}

std::string PictureNames::Layer(int frame, const std::string& layer) const {
  std::string name = picture_.text();
  const size_t file = name.find_last_of('/') + 1, ending = name.rfind('.');
  size_t place = ending == std::string::npos || ending < file ? name.size() : ending;
  // Before the number of the frame if that follows a dot.
  const size_t dot = place > file ? name.rfind('.', place - 1) : std::string::npos;
  if (dot != std::string::npos && dot >= file && FrameName(name.substr(dot, place - dot)).HasPlace())
    place = dot;
  name.insert(place, "." + layer);
  return NameOf(FrameName(name), frame);
}

Result<void> PictureNames::Check(const std::vector<int>& frames, const std::set<std::string>& inputs,
                                 const std::set<std::string>& layers) const {
  const auto format = PictureFormatOf(picture_.text());
  if (!format) return format.error();
  if (!exr_.IsAsFetched() && *format != PictureFormat::kExr) {
    return BadInput(
        fmt::format("{}: --aov-split, --compression, --exr-layout and --thumbnail are of .exr files alone",
                    picture_.text()));
  }
  if (exr_.splits_layers && (IsStream(picture_.text()) || !picture_.text().ends_with(".exr"))) {
    return BadInput(
        fmt::format("{}: --aov-split writes several files, so the name must end in .exr", picture_.text()));
  }
  if (auto named = png_.empty() ? Result<void>() : CheckPngName(png_.text()); !named) return named;
  FilesInUse files;
  for (const std::string& input : inputs) files.AddInput(input);
  for (const int frame : frames) {
    if (auto kept = CheckKept(Picture(frame), existing_); !kept) return kept;
    if (auto kept = CheckKept(Png(frame), existing_); !kept) return kept;
    if (auto added = files.AddOutput(Picture(frame)); !added) return added;
    for (const std::string& layer : layers) {
      if (auto kept = CheckKept(Layer(frame, layer), existing_); !kept) return kept;
      if (auto added = files.AddOutput(Layer(frame, layer)); !added) return added;
    }
    if (png_.empty()) continue;
    if (auto added = files.AddOutput(Png(frame)); !added) return added;
  }
  if (auto can_encode = CheckEncoder(*format); !can_encode) return can_encode;
  return png_.empty() ? Result<void>() : CheckEncoder(PictureFormat::kPng);
}

Result<void> PictureNames::CheckSize(int width, int height) const {
  return CheckFormatSize(picture_.text(), width, height);
}

}  // namespace tessera
