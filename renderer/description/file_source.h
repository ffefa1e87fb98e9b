// Where the files of a scene come from: the disk of the person who submits it, or a package of blobs on a
// worker.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "renderer/util/digest.h"
#include "renderer/util/result.h"
#include "renderer/util/shared_cache.h"

namespace tessera {

constexpr uint64_t kSceneFileSizeMax = uint64_t{4} << 30;  // bytes: larger than any asset we have met

// Gives the bytes of a file by the name that the scene uses for it, and what was made of these bytes before,
// for this or another scene: the frames of a sequence share most of their files. Thread safe.
class FileSource {
 public:
  FileSource() = default;
  // `cache` holds what is made of files; sources may share it. Nothing is kept without one.
  explicit FileSource(std::shared_ptr<SharedCache> cache) : cache_(std::move(cache)) {}
  virtual ~FileSource() = default;
  // The bytes of the file. An error that names it if there is none, it cannot be read or it is too large.
  virtual Result<std::string> Read(const std::string& name) = 0;
  // The digest of the file if it is known without reading it; the file then counts as read.
  virtual std::optional<Digest> Identify(const std::string&) { return std::nullopt; }

  // What was made of the file and kept under `what`, which names the type and all that it depends on besides
  // the file. Returns null if nothing was kept; the file counts as read if something was.
  template <typename T>
  std::shared_ptr<const T> Recall(const std::string& name, const std::string& what) {
    const auto digest = cache_ ? Identify(name) : std::nullopt;
    return digest ? cache_->Find<T>(Key(*digest, name, what)) : nullptr;
  }
  // Keeps what was made of a file that has been read.
  template <typename T>
  void Keep(const std::string& name, const std::string& what, std::shared_ptr<const T> value,
            uint64_t bytes) {
    const auto digest = cache_ ? Identify(name) : std::nullopt;
    if (digest) cache_->Keep(Key(*digest, name, what), std::move(value), bytes);
  }

  const std::shared_ptr<SharedCache>& cache() const { return cache_; }

 private:
  // With the name, because messages about a file name it and its ending decides its format.
  static std::string Key(const Digest& digest, const std::string& name, const std::string& what) {
    return what + '\n' + digest.Hex() + '\n' + name;
  }

  std::shared_ptr<SharedCache> cache_;
};

// Files on disk. Names are relative to the folder of the top-level scene file; a name not found there is
// tried as given. Remembers the digest and size of all that was read: a worker needs these files to render
// the scene.
class DiskFileSource : public FileSource {
 public:
  struct File {
    std::string path;  // on this disk
    Digest digest;
    uint64_t size = 0;
  };

  // `folder` is the folder of the top-level scene file. A cache also keeps the digests of files, for as long
  // as they do not change.
  explicit DiskFileSource(std::string folder, std::shared_ptr<SharedCache> cache = nullptr)
      : FileSource(std::move(cache)), folder_(std::move(folder)) {}
  Result<std::string> Read(const std::string& name) override;
  std::optional<Digest> Identify(const std::string& name) override;
  // By the name that the scene used, in order of name.
  std::map<std::string, File> FilesRead() const;

 private:
  std::string PathOf(const std::string& name) const;
  // False if the name was read before with other bytes.
  bool Remember(const std::string& name, const File& file);

  std::string folder_;
  mutable std::mutex mutex_;
  std::map<std::string, File> files_;
};

}  // namespace tessera
