#include "client/saved_picture.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "client/output/layer_files.h"
#include "client/output/output_file.h"
#include "client/output/output_target.h"
#include "client/output/picture_encoder.h"
#include "client/output/picture_format.h"
#include "proto/shell/console.h"
#include "proto/shell/program.h"
#include "renderer/denoise/denoise.h"
#include "renderer/film/picture_file.h"
#include "renderer/text/unicode.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

// Writes all layers but the colours, whose file it returns.
Result<std::string> SaveLayers(const LoadedPicture& picture, int frame, const PictureNames& names,
                               std::stop_token stop) {
  const auto layers = SplitLayers(picture);
  if (!layers) return layers.error();
  std::string colors;
  for (const LayerPicture& each : *layers) {
    auto bytes = EncodeExr(each.picture, FormatOf(each, names.exr()));
    if (!bytes) return bytes.error();
    if (each.layer.empty()) {
      colors = std::move(*bytes);
      continue;
    }
    const std::string path = names.Layer(frame, FileLayer(each.layer));
    if (auto written = WriteOutput(path, *bytes, stop, names.existing()); !written) return written.error();
  }
  if (colors.empty()) return Failed("the picture has no colours");
  return colors;
}

// The file of the picture in another form than that of the farm.
Result<std::string> EncodeAgain(const LoadedPicture& picture, int frame, const PictureNames& names,
                                std::stop_token stop) {
  if (names.exr().splits_layers) return SaveLayers(picture, frame, names, stop);
  if (auto ok = CheckCompression(picture, names.exr()); !ok) return ok.error();
  return EncodeExr(picture, FormatOf(picture, names.exr()));
}

// A picture that is not what was asked for is saved all the same.
void WarnIfNoisy(std::string_view exr, const std::string& path) {
  const auto header = ReadExrHeader(exr, path);
  if (!header) return;
  const auto failed = std::ranges::find(header->attributes, std::string_view(kDenoiseFailedAttribute),
                                        &PictureHeader::Attribute::name);
  if (failed == header->attributes.end()) return;
  PrintNote(
      "tessera: warning: {}: could not be denoised: {}; the picture is noisy, tessera denoise may try "
      "again\n",
      ShownPath(path), CleanText(failed->text, kReasonBytesMax));
}

// Returns where the OpenEXR file is, in a new folder for temporary files.
Result<std::string> Rescue(std::string_view exr, const std::string& path) {
  const std::string set = Environment("TMPDIR");
  std::string folder = (set.empty() ? "/tmp" : set) + "/tessera-rescued-XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr) return SystemError(folder, "cannot be created");
  const std::string rescued = folder + "/" + std::filesystem::path(path).stem().string() + ".exr";
  if (auto written = WriteFileAtomically(rescued, exr); !written) {
    ::rmdir(folder.c_str());
    return written.error();
  }
  return rescued;
}

Result<SavedPicture> Save(std::string_view exr, int frame, const PictureNames& names, std::stop_token stop) {
  const std::string path = names.Picture(frame), png = names.Png(frame);
  const auto format = PictureFormatOf(path);
  if (!format) return format.error();
  WarnIfNoisy(exr, path);
  std::optional<LoadedPicture> picture;
  const bool is_whole = *format == PictureFormat::kExr && names.exr().IsAsFetched();
  if (!is_whole || !png.empty()) {
    auto decoded = DecodeExr(exr, path);
    if (!decoded) return decoded.error();
    picture = std::move(*decoded);
  }
  std::string encoded;
  if (!is_whole) {
    auto other = *format == PictureFormat::kExr ? EncodeAgain(*picture, frame, names, stop)
                                                : EncodeAs(*format, *picture, path);
    if (!other) return other.error();
    encoded = std::move(*other);
  }
  const std::string_view bytes = is_whole ? exr : encoded;
  if (auto written = WriteOutput(path, bytes, stop, names.existing()); !written) return written.error();
  if (!png.empty()) {
    const auto copy = EncodeAs(PictureFormat::kPng, *picture, png);
    if (!copy) return copy.error();
    if (auto written = WriteOutput(png, *copy, stop, names.existing()); !written) return written.error();
  }
  return SavedPicture{frame, path, Sha256(bytes)};
}

}  // namespace

Result<SavedPicture> SavePicture(std::string_view exr, int frame, const PictureNames& names,
                                 std::stop_token stop, IfUnsaved if_unsaved) {
  auto saved = Save(exr, frame, names, std::move(stop));
  const std::string path = names.Picture(frame);
  if (saved || if_unsaved == IfUnsaved::kFail || saved.error().kind != ErrorKind::kFailed ||
      IsStandardOutput(path))
    return saved;
  const auto rescued = Rescue(exr, path);
  return Failed(saved.error().message +
                (rescued ? fmt::format("; the picture is kept as {}", ShownPath(*rescued))
                         : fmt::format("; nor can it be kept elsewhere: {}", rescued.error().message)));
}

std::string PicturesJson(const std::vector<SavedPicture>& pictures, bool is_sequence, double seconds) {
  nlohmann::ordered_json json;
  if (is_sequence) {
    json["frames"] = nlohmann::ordered_json::array();
    for (const SavedPicture& picture : pictures) {
      json["frames"].push_back(
          {{"frame", picture.frame}, {"output", picture.path}, {"sha256", picture.digest.Hex()}});
    }
  } else if (!pictures.empty()) {
    json["output"] = pictures.front().path;
    json["sha256"] = pictures.front().digest.Hex();
  }
  json["seconds"] = seconds;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace tessera
