#include "renderer/color/rgb_to_spectrum.h"

#include "renderer/color/rgb_table.h"

namespace tessera {
namespace {

// A largest component below this is black; its reciprocal would overflow.
constexpr float kBlack = 1e-30f;

bool IsGrey(Vec3 rgb) {
  return rgb.x == rgb.y && rgb.y == rgb.z;
}

}  // namespace

RgbToSpectrum::RgbToSpectrum(const RgbPrimaries& primaries, const float* table)
    : solver_(primaries), table_(table) {}

const float* RgbToSpectrum::Table() const {
  if (const float* const ready = table_.load(std::memory_order_acquire)) return ready;
  std::call_once(build_once_, [this] {
    built_ = BuildRgbTable(solver_);
    table_.store(built_.data(), std::memory_order_release);
  });
  return table_.load(std::memory_order_acquire);
}

SigmoidPolynomial RgbToSpectrum::Solve(Vec3 rgb) const {
  if (IsGrey(rgb)) return SigmoidSolver::Grey(rgb.x);
  const std::array<double, 3> target = {static_cast<double>(rgb.x), static_cast<double>(rgb.y),
                                        static_cast<double>(rgb.z)};
  return SigmoidSolver::ToPolynomial(solver_.Solve(target, {0, 0, 0}));
}

SigmoidPolynomial RgbToSpectrum::LookUp(Vec3 rgb) const {
  if (IsGrey(rgb)) return SigmoidSolver::Grey(rgb.x);
  if (MaxComponent(rgb) < kBlack) return SigmoidSolver::Grey(0);
  return LookUpRgbTable(Table(), rgb);
}

}  // namespace tessera
