// Fills a sparse grid from a file, within limits.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "renderer/medium/nanovdb_file.h"

namespace tessera {

using VdbOrigin = std::array<int64_t, 3>;

// Why a grid of this box cannot be read, or empty.
std::string BoxProblem(const IndexBox& box);

class VdbGridFiller {
 public:
  // `grid` must outlive this. Values must be finite and, unless `may_be_negative`, at least 0.
  VdbGridFiller(VdbGrid& grid, bool may_be_negative) : grid_(grid), may_be_negative_(may_be_negative) {}

  // Sets the voxels of a cube that are in the box of the grid. Returns false if something is wrong.
  bool Fill(const VdbOrigin& origin, int64_t side, float value);

  const std::string& problem() const { return problem_; }

 private:
  VdbGrid& grid_;
  bool may_be_negative_;
  int64_t voxels_ = 0;
  std::string problem_;
};

}  // namespace tessera
