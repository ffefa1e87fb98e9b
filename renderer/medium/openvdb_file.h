// Sparse grids from OpenVDB files (.vdb).
#pragma once

#include "renderer/medium/nanovdb_file.h"

namespace tessera {

// Whether the bytes start as an OpenVDB file does.
bool IsOpenVdb(std::string_view bytes);

// The same as ReadNanoVdb for the bytes of an OpenVDB file, which are untrusted: trees of floats or halves of
// the usual shape (5, 4, 3), not compressed or by zlib or Blosc with LZ4. Active voxels alone count for the
// box.
Result<std::shared_ptr<const VdbGrid>> ReadOpenVdb(std::string_view bytes, const std::string& file,
                                                   const std::string& name,
                                                   const std::optional<IndexBox>& box, bool may_be_negative);

}  // namespace tessera
