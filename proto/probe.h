// The result that every worker of this release must compute.
#pragma once

#include <string_view>

namespace tessera {

// The digest of the probe unit (renderer/scene/probe.h), in hexadecimal. A worker that computes another one
// is refused: its pictures would differ. A test of the renderer keeps it true. It changes, together with
// kSoftwareVersion, whenever a picture may change by a bit.
constexpr std::string_view kProbeDigest = "448999bc8909e8b8578285a0bccb3b485a4842ce4cec66e9fd73f80401c165bc";

}  // namespace tessera
