#include "renderer/medium/majorant_grid.h"

namespace tessera {

MajorantGrid::MajorantGrid(const GridSize& size, float bound) {
  const int longest = *std::max_element(size.begin(), size.end());
  while ((longest >> shift_) + 1 > kMajorantCellsMax) ++shift_;
  per_position_ = 1 / static_cast<float>(1 << shift_);
  size_t count = 1;
  for (int i = 0; i < 3; ++i) {
    cells_[i] = (size[i] >> shift_) + 1;
    count *= static_cast<size_t>(cells_[i]);
  }
  bounds_.assign(count, bound);
}

void MajorantGrid::Add(const MajorantGrid& other) {
  for (size_t i = 0; i < bounds_.size(); ++i) bounds_[i] += other.bounds_[i];
}

float MajorantGrid::At(Point3 position) const {
  GridSize cell{};
  for (int i = 0; i < 3; ++i) {
    const int last = (cells_[i] << shift_) - 1;
    cell[i] = static_cast<int>(std::clamp(position[i], 0.0f, static_cast<float>(last)));
  }
  return bounds_[IndexOf(cell)];
}

}  // namespace tessera
