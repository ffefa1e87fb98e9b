// What a job becomes when its frames get more samples, and how much space its sums take.
#pragma once

#include <memory>

#include "proto/terms.h"

namespace tessera {

uint64_t SamplesOf(const FrameSpec& spec);  // pixel samples
uint64_t SamplesOf(const JobSpec& spec);
// Bytes of the sums of a finished frame.
uint64_t SumsBytes(const FrameSpec& spec);
// Whether the frame may get more samples later. False for adaptive frames: some of their pixels have stopped,
// and whether others go on is decided from halves of their sums.
bool IsExtendable(const FrameRequest& frame);
// The job as if it had been submitted with this many samples per pixel, including what the headers of its
// pictures say. Frames that have as many or more stay as they are.
std::shared_ptr<const JobSpec> ExtendedSpec(const JobSpec& spec, uint32_t samples_per_pixel);

}  // namespace tessera
