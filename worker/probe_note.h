// A note that this program has passed the probe on this machine, so that the workers of local farms, which
// start for every picture, render it once and not each time. One thread uses it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

// Identifies all that the bits of a picture depend on: release, program and libraries, processor, settings of
// the C library, and the start of the machine. nullopt if the system does not tell.
std::optional<Digest> ProbeCircumstances();

// The digest of the probe unit: the expected one if `folder` has a note of the same circumstances, otherwise
// that of `render`, of which a note is made if it is the expected one. Without a folder or circumstances, or
// if the folder cannot be used or belongs to another user, it is that of `render`.
Result<Digest> NotedProbe(const std::string& folder, const std::optional<Digest>& circumstances,
                          const std::function<Result<Digest>()>& render);

}  // namespace tessera
