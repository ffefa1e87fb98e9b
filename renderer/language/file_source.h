// Where the files of a scene come from: the disk of the person who submits it, or a package of blobs on a
// worker.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "util/digest.h"
#include "util/result.h"

namespace tessera {

constexpr uint64_t kSceneFileSizeMax = uint64_t{4} << 30;  // bytes: larger than any asset we have met

// Gives the bytes of a file by the name that the scene uses for it. Thread safe.
class FileSource {
 public:
  virtual ~FileSource() = default;
  // An error that names the file if there is none, it cannot be read or it is too large.
  virtual Result<std::string> Read(const std::string& name) = 0;
};

// Files on disk. Names are relative to the folder of the top-level scene file; a name not found there is
// tried as given. Remembers the digest and size of all that was read: what a worker will need to render the
// scene.
class DiskFileSource : public FileSource {
 public:
  struct File {
    std::string path;  // on this disk
    Digest digest;
    uint64_t size = 0;
  };

  // `folder` is the folder of the top-level scene file.
  explicit DiskFileSource(std::string folder) : folder_(std::move(folder)) {}
  Result<std::string> Read(const std::string& name) override;
  // By the name that the scene used, in order of name.
  std::map<std::string, File> FilesRead() const;

 private:
  std::string folder_;
  mutable std::mutex mutex_;
  std::map<std::string, File> files_;
};

}  // namespace tessera
