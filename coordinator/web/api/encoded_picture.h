// The bytes of a picture for whoever downloads it.
#pragma once

#include <string>

#include "coordinator/core/spool.h"
#include "coordinator/web/api/web_farm.h"

namespace tessera {

// The EXR file of a finished frame, or of what there is of another; or the same as a PNG file, tone-mapped.
// May take long, and as much memory as the picture.
WebResult<std::string> EncodedPicture(const WebFarm& farm, FrameId frame, const FrameState& state,
                                      bool is_png);

// The same as a file to be sent. The EXR file of a finished frame is sent as it is, without a copy.
WebResult<ReadableFile> OpenPicture(const WebFarm& farm, FrameId frame, const FrameState& state, bool is_png);

}  // namespace tessera
