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

// The number of a file that is called PREFIX-NUMBER.
std::optional<uint64_t> NumberOf(const std::string& name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return std::nullopt;
  const char* const end = name.data() + name.size();
  uint64_t number = 0;
  const auto read = std::from_chars(name.data() + prefix.size(), end, number);
  if (read.ec != std::errc() || read.ptr != end || number == 0) return std::nullopt;
  return number;
}

void Remove(const std::string& path) {
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

}  // namespace

FrameFiles::FrameFiles(std::string folder) : folder_(std::move(folder)) {
  std::vector<std::string> old;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
    const std::string name = entry.path().filename().string();
    std::error_code ignored;
    const uint64_t bytes = entry.file_size(ignored);
    if (const auto segment = NumberOf(name, "segment-")) {
      segments_.push_back({*segment, bytes});
    } else if (const auto base = NumberOf(name, "base-")) {
      if (base_.number > 0) old.push_back(BasePath(std::min(base_.number, *base)));
      if (*base > base_.number) base_ = {*base, bytes};
    } else {
      old.push_back(entry.path().string());
    }
  }
  std::ranges::sort(segments_, {}, &File::number);
  std::erase_if(segments_, [&](const File& segment) {
    if (segment.number >= base_.number) return false;
    old.push_back(SegmentPath(segment.number));
    return true;
  });
  for (const std::string& path : old) Remove(path);
  base_next_ = base_.number;
}

void FrameFiles::SetGuard(SceneGuard guard) {
  const std::lock_guard lock(mutex_);
  guard_ = std::move(guard);
}
SceneGuard FrameFiles::guard() const {
  const std::lock_guard lock(mutex_);
  return guard_;
}

std::string FrameFiles::SegmentPath(uint64_t number) const {
  return fmt::format("{}/segment-{}", folder_, number);
}
std::string FrameFiles::BasePath(uint64_t number) const {
  return fmt::format("{}/base-{}", folder_, number);
}

Result<std::unique_ptr<NodeLog>> FrameFiles::BeginSegment() {
  if (const auto made = CreateFolders(folder_); !made) return made.error();
  const std::lock_guard lock(mutex_);
  const uint64_t newest = segments_.empty() ? 0 : segments_.back().number;
  const uint64_t number = std::max({newest + 1, base_next_, uint64_t{1}});
  auto log = NodeLog::Create(SegmentPath(number), guard_);
  if (log) segments_.push_back({number, (*log)->synced_bytes()});
  return log;
}

Result<std::unique_ptr<NodeLog>> FrameFiles::ReopenSegment(const std::function<void(TileNode)>& visit,
                                                           const RecordLog::OnTorn& on_torn) {
  const std::lock_guard lock(mutex_);
  if (segments_.empty()) return std::unique_ptr<NodeLog>();
  auto log = NodeLog::Open(SegmentPath(segments_.back().number), visit, guard_, on_torn);
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
  const std::string path = BasePath(number);
  const std::string beside = path + ".new";
  const auto write = [&]() -> Result<uint64_t> {
    auto log = NodeLog::Create(beside, guard());
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
      if (base_.number > 0) old.push_back(BasePath(base_.number));
      for (const File& segment : segments_) {
        if (segment.number < number) old.push_back(SegmentPath(segment.number));
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
  const SceneGuard guard = this->guard();
  std::vector<File> segments;
  File base;
  {
    const std::lock_guard lock(mutex_);
    segments = segments_;
    base = base_;
  }
  if (but_newest && !segments.empty()) segments.pop_back();
  if (base.number > 0) {
    const auto read = NodeLog::Read(BasePath(base.number), RecordLog::Tail::kWhole, visit, guard);
    if (!read) return read.error();
  }
  for (const File& segment : segments) {
    const bool is_newest = segment.number == segments.back().number && !but_newest;
    const auto tail = is_newest ? RecordLog::Tail::kMayBeTorn : RecordLog::Tail::kWhole;
    const auto read = NodeLog::Read(SegmentPath(segment.number), tail, visit, guard);
    if (!read) return read.error();
  }
  return {};
}

}  // namespace tessera
