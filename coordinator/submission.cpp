#include "coordinator/submission.h"

#include <fmt/format.h>

#include "proto/frame_name.h"
#include "proto/scene_package.h"
#include "renderer/denoise/finished_picture.h"

namespace tessera {

namespace {

Result<ScenePackage> ReadPackage(const Digest& digest, const BlobStore& blobs) {
  if (!blobs.UseVerified(digest)) return Failed("the manifest of the scene package was not uploaded");
  const auto manifest = blobs.Read(digest, kManifestBytesMax);
  if (!manifest) return manifest.error();
  return DecodeScenePackage(*manifest);
}

Result<void> CheckSceneFile(const ScenePackage& package, const std::string& path) {
  if (package.files.contains(path)) return {};
  return BadInput(fmt::format("{}: the scene file is not in the scene package", path));
}

// Checks every file, so that the client can send all that are damaged before it tries again.
Result<void> CheckFiles(const ScenePackage& package, const BlobStore& blobs) {
  Result<void> checked;
  for (const auto& [path, file] : package.files) {
    const auto size = blobs.UseVerified(file.digest);
    if (!checked) continue;
    if (!size) {
      checked = Failed(fmt::format("{}: was not uploaded", path));
    } else if (*size != file.size) {
      checked = BadInput(fmt::format("{}: the size given in the scene package is wrong", path));
    }
  }
  return checked;
}

}  // namespace

Result<void> CheckFrames(const std::vector<FrameRequest>& frames) {
  for (const FrameRequest& frame : frames) {
    if (auto ok = CheckDenoiser(frame.spec, frame.scene_file); !ok) return ok;
    if (auto ok = CheckInstalled(frame.spec.denoiser); !ok)
      return Failed(fmt::format("the coordinator cannot denoise the pictures: {}", ok.error().message));
  }
  return {};
}

Result<void> CheckSubmission(const JobSpec& spec, const BlobStore& blobs) {
  const auto package = ReadPackage(spec.package, blobs);
  if (!package) return package.error();
  for (const FrameRequest& frame : spec.frames) {
    if (auto known = CheckSceneFile(*package, frame.scene_file); !known) return known;
  }
  if (auto checked = CheckFrames(spec.frames); !checked) return checked;
  return CheckFiles(*package, blobs);
}

Result<void> CheckOrder(const SceneOrder& order, const BlobStore& blobs) {
  const auto package = ReadPackage(order.package, blobs);
  if (!package) return package.error();
  const FrameName name(order.scene_file);
  const std::vector<int> numbers = order.frames ? order.frames->Numbers() : std::vector<int>{0};
  for (const int number : numbers) {
    const std::string file = order.frames ? name.Of(number) : order.scene_file;
    if (auto known = CheckSceneFile(*package, file); !known) return known;
  }
  return CheckFiles(*package, blobs);
}

}  // namespace tessera
