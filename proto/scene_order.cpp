#include "proto/scene_order.h"

#include "proto/scene_package.h"
#include "proto/terms.h"

namespace tessera {

Result<void> CheckSceneOrder(const SceneOrder& order) {
  if (!IsPackagePath(order.scene_file)) return BadInput("scene_file is not a path in a package");
  if (order.options.size() > kOptionsBytesMax) return BadInput("options are too long");
  const double rate = order.frames_per_second;
  if (!(rate >= kOrderedRateMin && rate <= kOrderedRateMax))
    return BadInput("frames_per_second is out of range");
  if (!order.frames) return {};
  const FrameRange& frames = *order.frames;
  const bool is_range = frames.first >= 0 && frames.first <= frames.last && frames.last <= kFrameNumberMax &&
                        frames.step >= 1 && frames.step <= kFrameNumberMax;
  if (!is_range) return BadInput("frames are not a range");
  if ((frames.last - frames.first) / frames.step + 1 > kFramesPerJobMax)
    return BadInput("frames are too many for one job");
  return {};
}

}  // namespace tessera
