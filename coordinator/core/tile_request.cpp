#include "coordinator/core/tile_request.h"

namespace tessera {

Result<TileRequest> RequestOf(const JobSpec& job, const WorkUnit& unit) {
  if (unit.frame >= job.frames.size()) return Failed("there is no such unit");
  const FrameSpec& spec = job.frames[unit.frame].spec;
  if (unit.tile >= static_cast<uint32_t>(spec.TileCount())) return Failed("there is no such unit");
  return TileRequest{spec.TileBounds(static_cast<int>(unit.tile)), unit.range, spec.Layout().shape()};
}

}  // namespace tessera
