#include "coordinator/package_files.h"

#include <algorithm>

#include "proto/scene_package.h"

namespace tessera {

Result<bool> PackageFiles::Contains(const Digest& package, const Digest& blob) {
  if (blob == package) return true;
  Digests files = Find(package);
  if (files == nullptr) {
    const auto manifest = blobs_.Read(package, kManifestBytesMax);
    if (!manifest) return manifest.error();
    const auto read = DecodeScenePackage(*manifest);
    if (!read) return read.error();
    std::vector<Digest> digests;
    for (const auto& [path, file] : read->files) digests.push_back(file.digest);
    std::ranges::sort(digests);
    files = std::make_shared<const std::vector<Digest>>(std::move(digests));
    Keep(package, files);
  }
  return std::ranges::binary_search(*files, blob);
}

PackageFiles::Digests PackageFiles::Find(const Digest& package) {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(package);
  if (found == known_.end()) return nullptr;
  found->second.used = ++clock_;
  return found->second.files;
}

void PackageFiles::Keep(const Digest& package, Digests files) {
  const std::lock_guard lock(mutex_);
  while (!known_.empty() && count_ + files->size() > kFilesMax) {
    const auto oldest =
        std::ranges::min_element(known_, {}, [](const auto& each) { return each.second.used; });
    count_ -= oldest->second.files->size();
    known_.erase(oldest);
  }
  const size_t count = files->size();
  if (known_.try_emplace(package, Known{std::move(files), ++clock_}).second) count_ += count;
}

}  // namespace tessera
