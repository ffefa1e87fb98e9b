#include "coordinator/submission.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coordinator/core/guarded_result.h"
#include "coordinator/core/schedule/policy.h"
#include "proto/frame_name.h"
#include "proto/scene_package.h"
#include "proto/wire/channel.h"
#include "renderer/denoise/finished_picture.h"

namespace tessera {

namespace {

using Clock = std::chrono::steady_clock;

Result<ScenePackage> ReadPackage(const Digest& digest, const BlobStore& blobs) {
  if (!blobs.UseVerified(digest)) return Failed("the manifest of the scene package was not uploaded");
  const auto manifest = blobs.Read(digest, kManifestBytesMax);
  if (!manifest) return manifest.error();
  return DecodeScenePackage(*manifest);
}

// Whether a check of the package reads no file but its manifest.
bool IsQuickToCheck(const Digest& digest, const BlobStore& blobs) {
  if (!IsQuickToFind(blobs, {digest})) return false;
  const auto package = ReadPackage(digest, blobs);
  return !package || std::ranges::all_of(package->files, [&](const auto& each) {
    return IsQuickToFind(blobs, {each.second.digest});
  });
}

Result<void> CheckSceneFile(const ScenePackage& package, const std::string& path) {
  if (package.files.contains(path)) return {};
  return BadInput(fmt::format("{}: the scene file is not in the scene package", path));
}

// Checks every file, so that the client can send all that are damaged before it tries again.
Result<void> CheckFiles(const ScenePackage& package, const BlobStore& blobs, Clock::time_point deadline) {
  Result<void> checked;
  for (const auto& [path, file] : package.files) {
    if (Clock::now() > deadline)
      return Error{ErrorKind::kInterrupted, "the coordinator is still checking the files of the scene"};
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

// Tiles of frames that are begun are kept in memory: no frame may fill the limit of all by itself.
Result<void> CheckTileCount(const FrameRequest& frame) {
  const int tiles = frame.spec.TileCount();
  if (static_cast<uint64_t>(tiles) <= kActiveTilesMax) return {};
  return BadInput(fmt::format(
      "{}: tiles of {} pixels cut the frame into {}, more than the {} that a farm takes; submit it "
      "with larger tiles (--tile-size)",
      frame.scene_file, frame.spec.tile_size, tiles, kActiveTilesMax));
}

}  // namespace

Result<void> CheckFrames(const std::vector<FrameRequest>& frames) {
  for (const FrameRequest& frame : frames) {
    if (auto ok = CheckTileCount(frame); !ok) return ok;
    if (auto ok = CheckDenoiser(frame.spec, frame.scene_file); !ok) return ok;
    if (auto ok = CheckInstalled(frame.spec.denoiser); !ok)
      return Failed(fmt::format("the coordinator cannot denoise the pictures: {}", ok.error().message));
  }
  return {};
}

Result<void> CheckSubmission(const JobSpec& spec, const BlobStore& blobs, Clock::duration patience) {
  const auto deadline = Clock::now() + patience;
  const auto package = ReadPackage(spec.package, blobs);
  if (!package) return package.error();
  for (const FrameRequest& frame : spec.frames) {
    if (auto known = CheckSceneFile(*package, frame.scene_file); !known) return known;
  }
  if (auto checked = CheckFrames(spec.frames); !checked) return checked;
  return CheckFiles(*package, blobs, deadline);
}

void PostCheck(FileThreads& threads, const BlobStore& blobs, const Digest& package,
               std::function<void()> check) {
  threads.brief.Post([&threads, &blobs, package, check = std::move(check)] {
    const auto is_quick = GuardedResult([&]() -> Result<bool> { return IsQuickToCheck(package, blobs); });
    is_quick&&* is_quick ? check() : threads.lengthy.Post(check);
  });
}

Result<void> CheckOrder(const SceneOrder& order, const BlobStore& blobs, Clock::duration patience) {
  const auto deadline = Clock::now() + patience;
  const auto package = ReadPackage(order.package, blobs);
  if (!package) return package.error();
  const FrameName name(order.scene_file);
  const std::vector<int> numbers = order.frames ? order.frames->Numbers() : std::vector<int>{0};
  for (const int number : numbers) {
    const std::string file = order.frames ? name.Of(number) : order.scene_file;
    if (auto known = CheckSceneFile(*package, file); !known) return known;
  }
  return CheckFiles(*package, blobs, deadline);
}

grpc::Status NotRenderable(const Error& error) {
  return error.kind == ErrorKind::kInterrupted ? TryAgain(error.message) : ToStatus(error);
}

grpc::Status NotAdmitted(const Error& error) {
  if (error.kind == ErrorKind::kBadInput) return ToStatus(error);
  return {grpc::StatusCode::RESOURCE_EXHAUSTED, error.message};
}

}  // namespace tessera
