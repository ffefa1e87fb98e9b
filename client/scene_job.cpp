#include "client/scene_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <set>

#include "proto/package_names.h"
#include "proto/shell/console.h"
#include "renderer/text/unicode.h"
#include "renderer/util/cores.h"
#include "renderer/util/threads.h"

namespace tessera {
namespace {

// What is kept of a frame after it has been read.
struct ReadFrame {
  FrameRequest request;
  std::vector<std::string> warnings;
  uint64_t moving = 0;
  std::map<std::string, DiskFileSource::File> files;
};

// Reads frames on all cores.
class FrameReader {
 public:
  FrameReader(SceneJob& job, Scene::Depth first_depth, std::stop_token stop)
      : job_(job), first_depth_(first_depth), stop_(stop), read_(job.frames.size()) {}

  // Reads every frame, or only the first if all come from one file.
  Result<std::vector<ReadFrame>> Run() {
    const size_t count = job_.frames.front().is_animated ? 1 : job_.frames.size();
    const size_t thread_count = std::min(count, static_cast<size_t>(UsableCores()));
    ThreadGroup threads([this](const Error& why) { Fail(0, why); });
    // With fewer threads it takes longer.
    for (size_t i = 1; i < thread_count && threads.Start([this, count] { Work(count); }); ++i) {
    }
    Work(count);
    threads.Join();
    if (error_) return *error_;
    if (stop_.stop_requested()) return Error{ErrorKind::kInterrupted, "interrupted"};
    read_.resize(count);
    return std::move(read_);
  }

 private:
  void Work(size_t count) {
    for (size_t i = next_++; i < count && i < failed_ && !stop_.stop_requested(); i = next_++) {
      try {
        if (auto read = Read(i); !read) Fail(i, read.error());
      } catch (const std::exception& e) {  // out of memory
        Fail(i, Failed(fmt::format("{}: {}", job_.frames[i].path, e.what())));
      }
    }
  }
  Result<void> Read(size_t i) {
    auto loaded = LoadFrame(job_.frames[i], i == 0 ? first_depth_ : Scene::Depth::kCheck, job_.cache);
    if (!loaded) return loaded.error();
    const SceneFrame& frame = job_.frames[i];
    ScenePackage alone;
    for (const auto& [name, file] : loaded->files) {
      const std::string path = PackagePath(name);
      if (path.empty()) return BadInput(fmt::format("{}: the file name is too long for a farm", name));
      alone.files[path] = {file.digest, file.size};
    }
    auto request = RequestFrame(frame, PackagePath(frame.name()), *loaded->scene, alone);
    if (!request) return request.error();
    const SceneSummary& summary = loaded->scene->summary();
    read_[i] = {std::move(*request), summary.warnings, summary.moving, std::move(loaded->files)};
    if (i == 0) job_.scene = std::move(loaded->scene);
    return {};
  }
  void Fail(size_t i, const Error& error) {
    const std::lock_guard lock(mutex_);
    if (i >= failed_) return;
    failed_ = i;
    error_ = error;
  }

  SceneJob& job_;
  const Scene::Depth first_depth_;
  const std::stop_token stop_;
  std::vector<ReadFrame> read_;  // each written by one thread
  std::atomic<size_t> next_ = 0;
  std::atomic<size_t> failed_ = SIZE_MAX;  // the first frame that failed
  std::mutex mutex_;
  std::optional<Error> error_;  // of that frame
};

// Prints each warning once, however many frames have it.
void PrintWarnings(const SceneJob& job, const std::vector<ReadFrame>& frames) {
  std::set<std::string> printed;
  const auto print = [&](const std::string& warning) {
    if (printed.insert(warning).second)
      PrintNote("tessera: warning: {}\n", CleanText(warning, kReasonBytesMax));
  };
  for (const ReadFrame& frame : frames) {
    for (const std::string& warning : frame.warnings) print(warning);
  }
  if (job.frames.size() > 1 && job.frames[0].is_animated && frames[0].moving == 0) {
    print(fmt::format("{}: nothing in the scene moves, so all {} frames will look the same",
                      job.frames[0].path, job.frames.size()));
  }
}

// Puts the files of a frame into the package. The frames of a sequence are in one folder, so that a name
// means the same file in all of them.
Result<void> Pack(const SceneFrame& frame, const ReadFrame& read, SceneJob& job) {
  PackedScene& packed = job.packed;
  for (const auto& [name, file] : read.files) {
    const auto [entry, is_new] =
        packed.package.files.emplace(PackagePath(name), PackageFile{file.digest, file.size});
    if (!is_new && entry->second.digest != file.digest) {
      return Failed(
          fmt::format("{}: changed while the frames were being read; run the command again", file.path));
    }
    if (file.path.empty()) {
      packed.in_memory.emplace(file.digest, frame.text);
    } else {
      packed.disk_paths.emplace(file.digest, file.path);
      job.input_paths.insert(file.path);
    }
  }
  if (packed.package.files.size() > kFilesPerPackageMax) {
    return BadInput(fmt::format("{}: the job refers to {} files up to this frame; the limit is {}",
                                frame.path, packed.package.files.size(), kFilesPerPackageMax));
  }
  packed.frames.push_back(read.request);
  return {};
}

}  // namespace

Result<SceneJob> LoadSceneJob(const SceneOptions& options, Scene::Depth depth, std::stop_token stop) {
  auto frames = ListFrames(options);
  if (!frames) return frames.error();
  if (IsStandardInput(options)) {
    if (auto read = ReadStandardInput(*frames, stop); !read) return read.error();
  }
  SceneJob job;
  job.frames = std::move(*frames);
  if (job.frames.size() > 1) job.cache = std::make_shared<SharedCache>(kSharedBytesMax);
  const auto read = FrameReader(job, depth, stop).Run();
  if (!read) return read.error();
  PrintWarnings(job, *read);
  for (size_t i = 0; i < read->size(); ++i) {
    if (auto added = Pack(job.frames[i], (*read)[i], job); !added) return added.error();
  }
  for (size_t i = read->size(); i < job.frames.size(); ++i) {
    job.packed.frames.push_back(RequestFrameLike(job.packed.frames[0], job.frames[i], *job.scene));
  }
  job.packed.manifest = EncodeScenePackage(job.packed.package);
  job.packed.digest = Sha256(job.packed.manifest);
  return job;
}

}  // namespace tessera
