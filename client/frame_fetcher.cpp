#include "client/frame_fetcher.h"

#include <fmt/format.h>

#include <filesystem>

#include "client/output/output_file.h"
#include "client/temporary_folder.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

// Whether the file exists and has the digest.
bool HasDigest(const std::string& path, const Digest& digest) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  if (error) return false;
  const auto bytes = ReadFile(path, size);
  return bytes && Sha256(*bytes) == digest;
}

// Where a large picture is while it arrives: on the disk that it is for, if it is for a file.
std::string FolderFor(const std::string& picture) {
  std::error_code error;
  const auto kind = std::filesystem::status(picture, error).type();
  const bool is_file =
      kind == std::filesystem::file_type::regular || kind == std::filesystem::file_type::not_found;
  if (IsStandardOutput(picture) || !is_file) return TemporaryRoot();
  const std::string folder = std::filesystem::path(picture).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace

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
  const std::string path = names_.Picture(frame.number);
  if (names_.Png(frame.number).empty() && names_.exr().IsAsFetched() && !IsStandardOutput(path) &&
      HasDigest(path, *frame.file)) {
    saved_.push_back({frame.number, path, *frame.file});
    return {};
  }
  auto picture = client_.FetchPicture(job_, static_cast<uint32_t>(index), false, FolderFor(path));
  if (!picture) return picture.error();
  const auto exr = picture->Bytes();
  if (!exr) return exr.error();
  if (Sha256(*exr) != *frame.file) {
    return Failed(
        fmt::format("the picture of frame {} of job {} is not the one that the coordinator lists (SHA-256 "
                    "{}, expected {}); "
                    "run the command again",
                    frame.number, Number(job_), Sha256(*exr).Hex(), frame.file->Hex()));
  }
  return Keep(*exr, frame.number);
}

Result<bool> FrameFetcher::SavePreview(size_t index, int frame) {
  auto picture =
      client_.FetchPicture(job_, static_cast<uint32_t>(index), true, FolderFor(names_.Picture(frame)));
  // The coordinator has no such picture: it knew the job and the frame a moment ago.
  if (!picture && picture.error().kind == ErrorKind::kBadInput) return false;
  if (!picture) return picture.error();
  const auto exr = picture->Bytes();
  if (!exr) return exr.error();
  if (auto kept = Keep(*exr, frame); !kept) return kept.error();
  return true;
}

Result<void> FrameFetcher::Keep(std::string_view exr, int frame) {
  auto saved = SavePicture(exr, frame, names_, stop_, if_unsaved_);
  if (!saved) return saved.error();
  saved_.push_back(std::move(*saved));
  return {};
}

}  // namespace tessera
