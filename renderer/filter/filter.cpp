#include "renderer/filter/filter.h"

#include <cmath>

namespace tessera {
namespace {

using FilterReader = Filter (*)(ParameterReader& reader);

template <auto kRead>
Filter Read(ParameterReader& reader) {
  return Filter(kRead(reader));
}

constexpr Kind<FilterReader> kFilters[] = {
    {"box", Support::kSupported, Read<BoxFilter::Read>},
    {"gaussian", Support::kSupported, Read<TabulatedFilter::ReadGaussian>},
    {"mitchell", Support::kSupported, Read<TabulatedFilter::ReadMitchell>},
    {"sinc", Support::kSupported, Read<TabulatedFilter::ReadSinc>},
    {"triangle", Support::kSupported, Read<TriangleFilter::Read>},
};
constexpr KindTable<FilterReader> kFilterTable("filter", kFilters);

}  // namespace

Result<Filter> Filter::Read(const Entity& entity) {
  const Kind<FilterReader>* kind = kFilterTable.Find(entity.kind);
  if (kind == nullptr) return ErrorAt(entity.location, kFilterTable.Refusal(entity.kind));
  ParameterReader reader(entity);
  Filter filter = kind->reader(reader);
  if (Result<void> done = reader.Finish(); !done) return done.error();
  return filter;
}

FilterSample Filter::Sample(Point2 u) const {
  return Dispatch(kind_, [u](const auto& kind) { return kind.Sample(u); });
}

float Filter::Evaluate(Vec2 offset) const {
  const Vec2 r = radius();
  if (std::abs(offset.x) > r.x || std::abs(offset.y) > r.y) return 0;
  return Dispatch(kind_, [offset](const auto& kind) { return kind.Evaluate(offset); });
}

Vec2 Filter::radius() const {
  return Dispatch(kind_, [](const auto& kind) { return kind.radius(); });
}

KindList FilterKinds() {
  return kFilterTable.List();
}

}  // namespace tessera
