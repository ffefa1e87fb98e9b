// A renderer for simulations: every sample is a function of its pixel and index, so that pictures can be
// compared to the last bit with what a single machine renders.
#pragma once

#include "renderer/film/frame_spec.h"
#include "renderer/film/merger.h"
#include "renderer/film/radiance_tile.h"

namespace tessera {

// A frame of a few tiles with channels "R" and "W"; not adaptive.
FrameSpec SmallFrame(int width, int height, int tile_size, uint32_t samples_per_pixel);
// Adds a channel of every merge rule, and some that are written with the help of others.
void AddModelLayers(FrameSpec& spec);
// The sums of a unit of the picture named by `seed`.
RadianceTile RenderModel(uint64_t seed, const FrameSpec& spec, uint32_t tile, const PixelMask& pixels,
                         SampleRange range);
// The whole picture, merged tile by tile in the largest possible units.
Merger ReferenceMerger(uint64_t seed, const FrameSpec& spec);

// What a client orders that cannot read the scenes of the job.
JobOrder OrderOf(const JobSpec& spec);

}  // namespace tessera
