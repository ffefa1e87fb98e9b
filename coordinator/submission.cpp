#include "coordinator/submission.h"

#include <fmt/format.h>

#include "proto/scene_package.h"
#include "renderer/denoise/finished_picture.h"

namespace tessera {

Result<void> CheckSubmission(const JobSpec& spec, const BlobStore& blobs) {
  if (!blobs.UseVerified(spec.package)) return Failed("the manifest of the scene package was not uploaded");
  const auto manifest = blobs.Read(spec.package, kManifestBytesMax);
  if (!manifest) return manifest.error();
  const auto package = DecodeScenePackage(*manifest);
  if (!package) return package.error();
  for (const FrameRequest& frame : spec.frames) {
    if (!package->files.contains(frame.scene_file)) {
      return BadInput(fmt::format("{}: the scene file is not in the scene package", frame.scene_file));
    }
    if (auto ok = CheckDenoiser(frame.spec, frame.scene_file); !ok) return ok;
    if (auto ok = CheckInstalled(frame.spec.denoiser); !ok)
      return Failed(fmt::format("the coordinator cannot denoise the pictures: {}", ok.error().message));
  }
  // Checks every file, so that the client can send all that are damaged before it tries again.
  Result<void> checked;
  for (const auto& [path, file] : package->files) {
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

}  // namespace tessera
