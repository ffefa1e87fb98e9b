// From RGB albedos of one colour space to sigmoid polynomials, exactly or fast.
#pragma once

#include <atomic>
#include <mutex>
#include <vector>

#include "renderer/color/sigmoid_solver.h"
#include "renderer/math/vec.h"

namespace tessera {

// Immutable but for a table that the first fast lookup builds; safe to share between threads.
class RgbToSpectrum {
 public:
  // `table` as rgb_table.h describes it, alive as long as this; or nullptr to build it when it is first
  // needed.
  RgbToSpectrum(const RgbPrimaries& primaries, const float* table);

  // Both take components in [0, 1]; the same component three times gives exactly that constant.
  SigmoidPolynomial Solve(Vec3 rgb) const;
  SigmoidPolynomial LookUp(Vec3 rgb) const;
  // Whether LookUp need not build its table first, which takes seconds.
  bool HasTable() const { return table_.load(std::memory_order_acquire) != nullptr; }

 private:
  const float* Table() const;

  SigmoidSolver solver_;
  mutable std::atomic<const float*> table_;
  mutable std::once_flag build_once_;
  mutable std::vector<float> built_;
};

}  // namespace tessera
