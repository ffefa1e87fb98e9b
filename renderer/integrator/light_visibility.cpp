#include "renderer/integrator/light_visibility.h"

#include <optional>

#include "renderer/color/wavelengths.h"
#include "renderer/math/ray.h"
#include "renderer/util/hash.h"

namespace tessera {
namespace {

// Points that are examined. A few in a hundred of those of a hidden cell may be lit nevertheless.
constexpr int kCellProbes = 64, kBlockProbes = 32;
// The cube in which they lie, in sizes of a cell. Cells next to lit ones do not count as hidden: light may
// reach a part of them that the points miss.
constexpr float kProbedSize = 2;

float Farthest(const Bounds3& bounds) {
  float farthest = 0;
  for (int axis = 0; axis < 3; ++axis)
    farthest = std::max({farthest, std::abs(bounds.min[axis]), std::abs(bounds.max[axis])});
  return farthest;
}

}  // namespace

LightVisibility::LightVisibility(const World& world) : world_(world) {
  const Bounds3 bounds = world.geometry.Bounds();
  constexpr int kExponentMax = 100, kExponentMin = -100;  // sizes of cells and their inverses are finite
  const int top = bounds.empty() ? 0 : std::clamp(ExponentOf(Farthest(bounds)), kExponentMin, kExponentMax);
  first_exponent_ = top - kLevels + 1;
  for (int level = 0; level < kLevels; ++level) {
    size_[level] = std::ldexp(2.0f / kHalf, first_exponent_ + level);
    inverse_size_[level] = 1 / size_[level];
  }
}

LightVisibility::Cell LightVisibility::ExamineCell(const Place& place) const {
  const Place block{place.level, place.x / 2, place.y / 2, place.z / 2};
  if (StateOf(blocks_, block, &LightVisibility::ExamineBlock) == Cell::kLit) return Cell::kLit;
  const float size = size_[place.level];
  const auto center = [&](uint32_t cell) { return (static_cast<float>(cell) + 0.5f - kHalf) * size; };
  const uint64_t seed = Hash(0, place.level, place.x, place.y, place.z);
  const bool is_lit =
      AnyIsLit({center(place.x), center(place.y), center(place.z)}, kProbedSize * size, kCellProbes, seed);
  return is_lit ? Cell::kLit : Cell::kHidden;
}

LightVisibility::Cell LightVisibility::ExamineBlock(const Place& place) const {
  const float size = 2 * size_[place.level];
  const auto center = [&](uint32_t block) {
    return (static_cast<float>(block) + 0.5f - 0.5f * kHalf) * size;
  };
  const uint64_t seed = Hash(1, place.level, place.x, place.y, place.z);
  const bool is_lit = AnyIsLit({center(place.x), center(place.y), center(place.z)}, size, kBlockProbes, seed);
  return is_lit ? Cell::kLit : Cell::kHidden;
}

bool LightVisibility::AnyIsLit(Point3 center, float size, int count, uint64_t seed) const {
  for (int i = 0; i < count; ++i) {
    const uint64_t random = ExtendHash(seed, i);
    const auto offset = [&](int axis) {
      return (UniformFloatFromHash(ExtendHash(random, axis)) - 0.5f) * size;
    };
    if (IsLit(center + Vec3{offset(0), offset(1), offset(2)}, random)) return true;
  }
  return false;
}

bool LightVisibility::IsLit(Point3 p, uint64_t random) const {
  const auto uniform = [&](int dimension) { return UniformFloatFromHash(ExtendHash(random, 3 + dimension)); };
  ReferencePoint reference;
  reference.p = p;
  reference.time = Lerp(uniform(0), world_.camera.shutter_open(), world_.camera.shutter_close());
  const std::optional<ChosenLight> chosen = world_.lights.Choose(reference, uniform(1));
  if (!chosen) return false;
  const SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(uniform(2));
  const std::optional<LightSample> light =
      world_.lights.Sample(chosen->light, reference, {uniform(3), uniform(4)}, wavelengths);
  if (!light || light->IsDark()) return false;
  if (!world_.links.CastsShadows(chosen->light)) return true;
  return !world_.accelerator->Occluded(
      SpawnRayTo(p, {}, {}, light->p, light->p_error, light->n, reference.time));
}

}  // namespace tessera
