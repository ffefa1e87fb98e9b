#include "coordinator/store/file_spool.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <utility>

#include "renderer/util/check.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr std::string_view kDropped = "dropped-";

// The frame whose folder is called JOB-FRAME.
std::optional<FrameId> FrameOf(const std::string& name) {
  const char* const end = name.data() + name.size();
  uint64_t job = 0;
  FrameId id;
  const auto first = std::from_chars(name.data(), end, job);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != '-') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, id.frame);
  if (second.ec != std::errc() || second.ptr != end) return std::nullopt;
  id.job = JobId{job};
  return id;
}

void RemoveFolder(const std::string& path) {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

}  // namespace

Result<std::unique_ptr<FileSpool>> FileSpool::Open(const std::string& path, Run run,
                                                   uint64_t segment_bytes_min) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return Failed(fmt::format("{}: cannot be created: {}", path, error.message()));
  std::unique_ptr<FileSpool> spool(new FileSpool(path, std::move(run), segment_bytes_min));
  if (const auto scanned = spool->Scan(); !scanned) return scanned.error();
  return spool;
}

Result<void> FileSpool::Scan() {
  const auto paths = ListFolder(path_);
  if (!paths) return paths.error();
  for (const std::string& path : *paths) {
    const std::string name = std::filesystem::path(path).filename().string();
    if (name.starts_with(kDropped)) {
      RemoveFolder(path);
    } else if (const auto id = FrameOf(name)) {
      // A frame that counted as empty would be rendered again, over the results that it has.
      if (const auto scanned = Need(*id).files->Scan(); !scanned) return scanned;
    }
  }
  return {};
}

std::string FileSpool::FolderOf(FrameId id) const {
  return fmt::format("{}/{}-{}", path_, Number(id.job), id.frame);
}

FileSpool::Frame& FileSpool::Need(FrameId id) {
  Frame& frame = frames_[id];
  if (frame.files == nullptr) frame.files = std::make_shared<FrameFiles>(FolderOf(id));
  if (scene_of_ && !std::exchange(frame.is_guarded, true))
    frame.files->SetGuard({scene_of_(id), on_foreign_});
  return frame;
}

void FileSpool::NameScenes(SceneOf scene_of, std::function<void(const std::string& path)> on_foreign) {
  scene_of_ = std::move(scene_of);
  on_foreign_ = std::move(on_foreign);
}

Result<void> FileSpool::BindToScenes() {
  for (auto& [id, frame] : frames_) {
    const auto scene = scene_of_(id);
    if (!scene) continue;
    if (const auto bound = frame.files->BindTo(*scene); !bound) return bound;
  }
  return {};
}

std::vector<FileSpool::Found> FileSpool::Frames() const {
  std::vector<Found> all;
  for (const auto& [id, frame] : frames_)
    all.push_back({id, frame.files->bytes(), frame.files->has_segments()});
  return all;
}

Result<void> FileSpool::Restore(FrameId id, const std::function<void(TileNode)>& restore,
                                const RecordLog::OnTorn& on_torn) {
  Frame& frame = Need(id);
  if (const auto read = frame.files->Read(true, restore); !read) return read.error();
  auto segment = frame.files->ReopenSegment(restore, on_torn);
  if (!segment) return segment.error();
  frame.segment = std::move(*segment);
  if (frame.segment == nullptr) return {};
  open_.insert(id);
  NoteOpenFile(id);
  return {};
}

void FileSpool::NoteOpenFile(FrameId id) {
  open_files_.remove(id);
  open_files_.push_front(id);
  if (open_files_.size() <= kOpenFilesMax) return;
  frames_.at(open_files_.back()).segment->ReleaseFile();
  open_files_.pop_back();
}

void FileSpool::Append(FrameId id, TileNode node) {
  Need(id).pending.push_back(std::move(node));
  unsynced_.insert(id);
}

Result<void> FileSpool::Sync() {
  while (!unsynced_.empty()) {
    const FrameId id = *unsynced_.begin();
    const auto synced = SyncFrame(id, frames_.at(id));
    if (!synced) return synced;
    unsynced_.erase(id);
  }
  return {};
}

Result<void> FileSpool::SyncFrame(FrameId id, Frame& frame) {
  if (IsGrown(*frame.files)) {
    // The disk is slower than the results: they wait. If it has no room for a base they wait as well, and the
    // next call is preceded by another attempt; but for a frame that is complete, which gets its last base
    // only after this.
    if (const auto written = frame.files->AwaitBase(); !written) return written;
  }
  if (frame.segment == nullptr) {
    auto segment = frame.files->BeginSegment();
    if (!segment) return segment.error();
    frame.segment = std::move(*segment);
    open_.insert(id);
  }
  NoteOpenFile(id);
  for (TileNode& node : std::exchange(frame.pending, {})) frame.segment->Append(std::move(node));
  if (const auto synced = frame.segment->Sync(); !synced) return synced;
  frame.files->SetSegmentBytes(frame.segment->synced_bytes());
  return {};
}

bool FileSpool::IsGrown(const FrameFiles& files) const {
  return files.segment_bytes() >= std::max(segment_bytes_min_, files.base_bytes());
}

std::vector<FrameId> FileSpool::Grown() const {
  std::vector<FrameId> grown;
  for (const FrameId id : open_) {
    const Frame& frame = frames_.at(id);
    if (!frame.segment->has_pending() && IsGrown(*frame.files) && !frame.files->is_writing_base())
      grown.push_back(id);
  }
  return grown;
}

void FileSpool::Replace(FrameId id, std::vector<TileNode> nodes) {
  Frame& frame = Need(id);
  TESSERA_CHECK(frame.segment == nullptr || !frame.segment->has_pending());
  static_cast<void>(frame.files->AwaitBase());  // a frame that is complete may have one underway
  frame.segment.reset();
  open_.erase(id);
  open_files_.remove(id);
  const uint64_t number = frame.files->BeginBase();
  const auto shared = std::make_shared<std::vector<TileNode>>(std::move(nodes));
  run_([files = frame.files, number, shared] { files->WriteBase(number, std::move(*shared)); });
}

void FileSpool::Drop(FrameId id) {
  const auto found = frames_.find(id);
  if (found == frames_.end()) return;
  frames_.erase(found);
  open_.erase(id);
  open_files_.remove(id);
  unsynced_.erase(id);
  // Out of the way at once; the files go in the background.
  const std::string folder = FolderOf(id);
  const std::string away = fmt::format("{}/{}{}-{}-{}", path_, kDropped, Number(id.job), id.frame, ++drops_);
  std::error_code error;
  std::filesystem::rename(folder, away, error);
  run_([path = error ? folder : away] { RemoveFolder(path); });
}

void FileSpool::Load(FrameId id, OnLoaded done) {
  if (!frames_.contains(id)) {
    done(Failed(fmt::format("{}: is not there", FolderOf(id))));
    return;
  }
  run_([files = Need(id).files, done = std::move(done)] {
    std::vector<TileNode> nodes;
    const auto read = files->Read(false, [&](TileNode node) { nodes.push_back(std::move(node)); });
    done(read ? Result<std::vector<TileNode>>(std::move(nodes)) : read.error());
  });
}

}  // namespace tessera
