#include "proto/sequence/sequence_frames.h"

#include "proto/frame_name.h"
#include "proto/package_names.h"
#include "renderer/denoise/finished_picture.h"

namespace tessera {

std::vector<SequenceFrame> FramesOf(const std::string& path, const RenderOptions& options,
                                    const std::optional<FrameRange>& range, double frames_per_second) {
  if (!range) return {{0, path, options, false}};
  const FrameName name(path);
  std::vector<SequenceFrame> frames;
  for (const int number : range->Numbers()) {
    SequenceFrame frame{number, name.Of(number), options, !name.HasPlace()};
    if (frame.is_animated) {
      frame.options.time = number / frames_per_second;
      frame.options.time_step = range->step / frames_per_second;
    }
    frame.options.frame = number;
    frame.options.frames_per_second = frames_per_second;
    frames.push_back(std::move(frame));
  }
  return frames;
}

Result<FrameRequest> RequestFrame(const SequenceFrame& frame, std::string scene_file, const Scene& scene,
                                  const ScenePackage& files) {
  FrameRequest request{std::move(scene_file), EncodeRenderOptions(frame.options), scene.frame(), frame.number,
                       scene.summary().extendable};
  request.spec.attributes[kSceneDigestAttribute] = Sha256(EncodeScenePackage(files)).Hex();
  if (auto ok = CheckDenoiser(request.spec, frame.path); !ok) return ok.error();
  return request;
}

FrameRequest RequestFrameLike(const FrameRequest& first, const SequenceFrame& frame, const Scene& scene) {
  FrameRequest request = first;
  scene.SetFrameAttributes(frame.options, request.spec.attributes);
  request.options = EncodeRenderOptions(frame.options);
  request.number = frame.number;
  return request;
}

}  // namespace tessera
