// The idiom for a value that is one of several kinds: a std::variant with one alternative per kind, and
// Dispatch for whatever depends on the kind.
//
//   using AnyShape = std::variant<Sphere, Disk>;
//
//   // The kinds share an interface, each in its own file.
//   float Area(const AnyShape& shape) {
//     return Dispatch(shape, [](const auto& kind) { return kind.Area(); });
//   }
//
//   // The kinds are treated differently at one place.
//   return Dispatch(shape, Overloads{
//                              [](const Sphere& sphere) { return sphere.radius; },
//                              [](const Disk& disk) { return disk.outer_radius; },
//                          });
//
// A kind that is added to the variant does not compile until every Dispatch handles it: in the first form it
// needs the member that is called, in the second a lambda of its own. That holds as long as no kind is
// handled by a catch-all: do not pass Overloads an `auto` or `...` parameter, do not name alternatives by
// number, and do not write chains of std::get_if. A question about one kind alone ("is it an interface?") is
// std::holds_alternative.
//
// Kinds that differ by name alone, without data, are an enum class and a switch without `default`; the
// compiler (-Wswitch) rejects a forgotten enumerator there.
#pragma once

#include <concepts>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <variant>

namespace tessera {

// One callable made of several lambdas, of which the type of the argument chooses one.
template <typename... Cases>
struct Overloads : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Overloads(Cases...) -> Overloads<Cases...>;

namespace dispatch {

// As many as the switch in Dispatch has cases. To allow more, add cases.
constexpr size_t kKindsMax = 16;

template <typename Variant>
struct Kinds;
template <typename... Kind>
struct Kinds<std::variant<Kind...>> {
  template <typename T>
  static constexpr bool kInclude = (std::is_same_v<T, Kind> || ...);
  template <typename Visitor>
  static constexpr bool kAreHandledBy = (std::invocable<Visitor&, Kind&> && ...);
};
template <typename... Kind>
struct Kinds<const std::variant<Kind...>> : Kinds<std::variant<Kind...>> {
  template <typename Visitor>
  static constexpr bool kAreHandledBy = (std::invocable<Visitor&, const Kind&> && ...);
};

template <size_t kIndex, typename Result, typename Variant, typename Visitor>
[[gnu::always_inline]] constexpr Result Call(Variant& value, Visitor& visitor) {
  if constexpr (kIndex < std::variant_size_v<std::remove_const_t<Variant>>) {
    using CaseResult = decltype(visitor(*std::get_if<kIndex>(&value)));
    static_assert(std::is_same_v<CaseResult, Result>, "the visitor must return the same type for every kind");
    return visitor(*std::get_if<kIndex>(&value));
  } else {
    __builtin_unreachable();
  }
}

}  // namespace dispatch

// For values that are made of any one of the kinds.
template <typename T, typename Variant>
concept AlternativeOf = dispatch::Kinds<Variant>::template kInclude<T>;

// The visitor takes every kind, with the constness of the variant.
template <typename Visitor, typename Variant>
concept HandlesKindsOf = dispatch::Kinds<Variant>::template kAreHandledBy<Visitor>;

// Returns visitor(kind) for the alternative that `value` holds, by reference, const if `value` is. The same
// as std::visit, but always a switch that the compiler can inline into the caller, where std::visit calls
// through a table of pointers if there are more than eleven kinds. The behaviour is undefined if `value` is
// valueless, so alternatives must not throw while they are assigned or emplaced.
template <typename Variant, HandlesKindsOf<Variant> Visitor>
[[gnu::always_inline]] constexpr decltype(auto) Dispatch(Variant& value, Visitor&& visitor) {
  static_assert(std::variant_size_v<std::remove_const_t<Variant>> <= dispatch::kKindsMax);
  using Result = decltype(visitor(*std::get_if<0>(&value)));
  using dispatch::Call;
  switch (value.index()) {
    case 0: return Call<0, Result>(value, visitor);
    case 1: return Call<1, Result>(value, visitor);
    case 2: return Call<2, Result>(value, visitor);
    case 3: return Call<3, Result>(value, visitor);
    case 4: return Call<4, Result>(value, visitor);
    case 5: return Call<5, Result>(value, visitor);
    case 6: return Call<6, Result>(value, visitor);
    case 7: return Call<7, Result>(value, visitor);
    case 8: return Call<8, Result>(value, visitor);
    case 9: return Call<9, Result>(value, visitor);
    case 10: return Call<10, Result>(value, visitor);
    case 11: return Call<11, Result>(value, visitor);
    case 12: return Call<12, Result>(value, visitor);
    case 13: return Call<13, Result>(value, visitor);
    case 14: return Call<14, Result>(value, visitor);
    case 15: return Call<15, Result>(value, visitor);
  }
  __builtin_unreachable();
}

}  // namespace tessera
