#include "client/frame_fetcher.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "client/frame_names.h"
#include "client/output.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

// Whether the file is there with these bytes.
bool Holds(const std::string& path, const Digest& digest) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  if (error) return false;
  const auto bytes = ReadFile(path, size);
  return bytes && Sha256(*bytes) == digest;
}

}  // namespace

PictureNames::PictureNames(const std::string& output, const std::string& png, Numbers numbers)
    : output_(numbers == Numbers::kAlways ? AsFramePattern(output) : output),
      png_(numbers == Numbers::kAlways && !png.empty() ? AsFramePattern(png) : png),
      numbers_(numbers) {}

std::string PictureNames::NameOf(const std::string& name, int frame) const {
  return numbers_ == Numbers::kNone ? name : NameOfFrame(name, frame);
}

Result<void> PictureNames::Check(const std::vector<int>& frames) const {
  for (const int frame : frames) {
    if (auto writable = CheckWritable(Exr(frame)); !writable) return writable;
    if (png_.empty()) continue;
    if (auto writable = CheckWritable(Png(frame)); !writable) return writable;
  }
  return {};
}

Result<void> FrameFetcher::SaveFinished() {
  const auto frames = client_.Frames(job_);
  if (!frames) return frames.error();
  is_saved_.resize(frames->size());
  for (size_t i = 0; i < frames->size(); ++i) {
    if (is_saved_[i] || !(*frames)[i].file) continue;
    if (auto saved = Save(i, (*frames)[i]); !saved) return saved;
    is_saved_[i] = true;
  }
  return {};
}

Result<void> FrameFetcher::Save(size_t index, const FrameStatus& frame) {
  const std::string path = names_.Exr(frame.number), png = names_.Png(frame.number);
  saved_.push_back({frame.number, path, *frame.file});
  if (png.empty() && Holds(path, *frame.file)) return {};
  const auto exr = client_.FetchPicture(job_, static_cast<uint32_t>(index), false);
  if (!exr) return exr.error();
  return WritePicture(*exr, path, png);
}

Result<void> FrameFetcher::SavePreview(size_t index, int frame) {
  const auto exr = client_.FetchPicture(job_, static_cast<uint32_t>(index), true);
  if (!exr) return exr.error();
  saved_.push_back({frame, names_.Exr(frame), Sha256(*exr)});
  return WritePicture(*exr, names_.Exr(frame), names_.Png(frame));
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
