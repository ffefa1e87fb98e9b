#include "coordinator/store/frame_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include "renderer/util/check.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr const char* kSegment = "segment-";
constexpr const char* kBase = "base-";
constexpr std::string_view kOfScene = "-of-";

// What the name of a file, PREFIX NUMBER or PREFIX NUMBER-of-SCENE, tells about it.
std::optional<FrameFiles::File> FileOf(std::string_view name, std::string_view prefix, uint64_t bytes) {
  if (!name.starts_with(prefix)) return std::nullopt;
  name.remove_prefix(prefix.size());
  FrameFiles::File file{0, bytes};
  const auto read = std::from_chars(name.data(), name.data() + name.size(), file.number);
  if (read.ec != std::errc() || file.number == 0) return std::nullopt;
  name.remove_prefix(static_cast<size_t>(read.ptr - name.data()));
  if (name.empty()) return file;
  if (!name.starts_with(kOfScene)) return std::nullopt;
  file.scene = Digest::FromHex(std::string(name.substr(kOfScene.size())));
  return file.scene ? std::optional(file) : std::nullopt;
}

std::string NameOf(const char* prefix, const FrameFiles::File& file) {
  return fmt::format("{}{}{}", prefix, file.number,
                     file.scene ? std::string(kOfScene) + file.scene->Hex() : "");
}

void Remove(const std::string& path) {
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

}  // namespace

Result<void> FrameFiles::Scan() {
  const auto paths = ListFolder(folder_);
  if (!paths) return paths.error();
  const std::lock_guard lock(mutex_);
  std::vector<std::string> old;
  for (const std::string& path : *paths) {
    const std::string name = std::filesystem::path(path).filename().string();
    std::error_code error;
    const uint64_t bytes = std::filesystem::file_size(path, error);
    const auto segment = FileOf(name, kSegment, bytes), base = FileOf(name, kBase, bytes);
    if (error && (segment || base))
      return Failed(fmt::format("{}: cannot be examined: {}", path, error.message()));
    if (segment) {
      segments_.push_back(*segment);
    } else if (base) {
      const bool is_newer = base->number > base_.number;
      if (base_.number > 0) old.push_back(BasePath(is_newer ? base_ : *base));
      if (is_newer) base_ = *base;
    } else {
      old.push_back(path);
    }
  }
  std::ranges::sort(segments_, {}, &File::number);
  std::erase_if(segments_, [&](const File& segment) {
    if (segment.number >= base_.number) return false;
    old.push_back(SegmentPath(segment));
    return true;
  });
  for (const std::string& path : old) Remove(path);
  base_next_ = base_.number;
  return {};
}

void FrameFiles::SetGuard(SceneGuard guard) {
  const std::lock_guard lock(mutex_);
  guard_ = std::move(guard);
}

SceneGuard FrameFiles::GuardOf(const File& file) const {
  SceneGuard guard = guard_;
  guard.bound = file.scene;
  return guard;
}

std::string FrameFiles::SegmentPath(const File& segment) const {
  return folder_ + "/" + NameOf(kSegment, segment);
}
std::string FrameFiles::BasePath(const File& base) const {
  return folder_ + "/" + NameOf(kBase, base);
}

Result<void> FrameFiles::BindTo(const Digest& scene) {
  const std::lock_guard lock(mutex_);
  const auto bind = [&](File& file, const char* prefix) -> Result<void> {
    if (file.number == 0 || file.scene) return {};
    File bound = file;
    bound.scene = scene;
    const std::string from = folder_ + "/" + NameOf(prefix, file), to = folder_ + "/" + NameOf(prefix, bound);
    if (std::rename(from.c_str(), to.c_str()) != 0) return SystemError(from, "cannot be renamed");
    file = bound;
    return {};
  };
  if (const auto bound = bind(base_, kBase); !bound) return bound;
  for (File& segment : segments_) {
    if (const auto bound = bind(segment, kSegment); !bound) return bound;
  }
  return base_.number > 0 || !segments_.empty() ? SyncFolder(folder_) : Result<void>();
}

Result<std::unique_ptr<NodeLog>> FrameFiles::BeginSegment() {
  if (const auto made = CreateFolders(folder_); !made) return made.error();
  const std::lock_guard lock(mutex_);
  const uint64_t newest = segments_.empty() ? 0 : segments_.back().number;
  const uint64_t number = std::max({newest + 1, base_next_, uint64_t{1}});
  auto log = NodeLog::Create(SegmentPath({number}), guard_);
  if (log) segments_.push_back({number, (*log)->synced_bytes()});
  return log;
}

Result<std::unique_ptr<NodeLog>> FrameFiles::ReopenSegment(const std::function<void(TileNode)>& visit,
                                                           const RecordLog::OnTorn& on_torn) {
  const std::lock_guard lock(mutex_);
  if (segments_.empty()) return std::unique_ptr<NodeLog>();
  auto log = NodeLog::Open(SegmentPath(segments_.back()), visit, GuardOf(segments_.back()), on_torn);
  if (log && *log != nullptr) segments_.back().bytes = (*log)->synced_bytes();
  return log;
}

void FrameFiles::SetSegmentBytes(uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  TESSERA_CHECK(!segments_.empty());
  segments_.back().bytes = bytes;
}

uint64_t FrameFiles::segment_bytes() const {
  const std::lock_guard lock(mutex_);
  return segments_.empty() || segments_.back().number < base_next_ ? 0 : segments_.back().bytes;
}

uint64_t FrameFiles::base_bytes() const {
  const std::lock_guard lock(mutex_);
  return base_.bytes;
}

uint64_t FrameFiles::bytes() const {
  const std::lock_guard lock(mutex_);
  uint64_t bytes = base_.bytes;
  for (const File& segment : segments_) bytes += segment.bytes;
  return bytes;
}

bool FrameFiles::has_segments() const {
  const std::lock_guard lock(mutex_);
  return !segments_.empty();
}

uint64_t FrameFiles::BeginBase() {
  const std::lock_guard lock(mutex_);
  TESSERA_CHECK(!is_writing_);
  is_writing_ = true;
  base_next_ = std::max(base_next_, segments_.empty() ? 0 : segments_.back().number) + 1;
  return base_next_;
}

Result<uint64_t> FrameFiles::WriteBaseFile(uint64_t number, std::vector<TileNode> nodes) const {
  const std::string path = BasePath({number});
  const std::string beside = path + ".new";
  std::unique_lock lock(mutex_);
  const SceneGuard guard = guard_;
  lock.unlock();
  const auto write = [&]() -> Result<uint64_t> {
    auto log = NodeLog::Create(beside, guard);
    if (!log) return log.error();
    for (TileNode& node : nodes) (*log)->Append(std::move(node));
    if (const auto synced = (*log)->Sync(); !synced) return synced.error();
    if (std::rename(beside.c_str(), path.c_str()) != 0)
      return Failed(fmt::format("{}: cannot be written: {}", path, std::strerror(errno)));
    if (const auto kept = SyncFolder(folder_); !kept) return kept.error();
    return (*log)->synced_bytes();
  };
  auto written = write();
  if (!written) Remove(beside);
  return written;
}

void FrameFiles::WriteBase(uint64_t number, std::vector<TileNode> nodes) {
  const auto written = WriteBaseFile(number, std::move(nodes));
  std::vector<std::string> old;
  {
    const std::lock_guard lock(mutex_);
    outcome_ = written ? Result<void>() : written.error();
    if (written) {
      if (base_.number > 0) old.push_back(BasePath(base_));
      for (const File& segment : segments_) {
        if (segment.number < number) old.push_back(SegmentPath(segment));
      }
    }
  }
  for (const std::string& path : old) Remove(path);
  const std::lock_guard lock(mutex_);
  if (written) {
    base_ = {number, *written};
    std::erase_if(segments_, [&](const File& segment) { return segment.number < number; });
  }
  is_writing_ = false;
  base_ended_.notify_all();
}

bool FrameFiles::is_writing_base() const {
  const std::lock_guard lock(mutex_);
  return is_writing_;
}

Result<void> FrameFiles::AwaitBase() {
  std::unique_lock lock(mutex_);
  base_ended_.wait(lock, [this] { return !is_writing_; });
  return std::exchange(outcome_, {});
}

Result<void> FrameFiles::Read(bool but_newest, const std::function<void(TileNode)>& visit) const {
  struct Log {
    std::string path;
    SceneGuard guard;
    RecordLog::Tail tail = RecordLog::Tail::kWhole;
  };
  std::vector<Log> logs;
  {
    const std::lock_guard lock(mutex_);
    if (base_.number > 0) logs.push_back({BasePath(base_), GuardOf(base_)});
    for (const File& segment : segments_) logs.push_back({SegmentPath(segment), GuardOf(segment)});
    if (!segments_.empty() && but_newest) {
      logs.pop_back();
    } else if (!segments_.empty()) {
      logs.back().tail = RecordLog::Tail::kMayBeTorn;
    }
  }
  for (const Log& log : logs) {
    if (const auto read = NodeLog::Read(log.path, log.tail, visit, log.guard); !read) return read;
  }
  return {};
}

}  // namespace tessera
