#include "renderer/util/dispatch.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <variant>

namespace tessera {
namespace {

template <int kNumber>
struct Numbered {
  int Number() const { return kNumber; }
};

template <size_t... kIndices>
std::variant<Numbered<static_cast<int>(kIndices)>...> VariantOf(std::index_sequence<kIndices...>);
using MostKinds = decltype(VariantOf(std::make_index_sequence<dispatch::kKindsMax>()));

template <size_t... kIndices>
std::array<MostKinds, sizeof...(kIndices)> OneOfEachKind(std::index_sequence<kIndices...>) {
  return {MostKinds(std::in_place_index<kIndices>)...};
}

TEST(Dispatch, CallsTheVisitorWithTheKindThatIsHeld) {
  int expected = 0;
  for (const MostKinds& value : OneOfEachKind(std::make_index_sequence<dispatch::kKindsMax>())) {
    EXPECT_EQ(Dispatch(value, [](const auto& kind) { return kind.Number(); }), expected++);
  }
  EXPECT_EQ(expected, 16);
}

TEST(Dispatch, OverloadsChooseByTheKind) {
  using Value = std::variant<int, std::string>;
  const Overloads describe{
      [](int number) { return "number " + std::to_string(number); },
      [](const std::string& text) { return "text " + text; },
  };
  const Value number = 7, text = "seven";
  EXPECT_EQ(Dispatch(number, describe), "number 7");
  EXPECT_EQ(Dispatch(text, describe), "text seven");
}

TEST(Dispatch, TheVisitorMayChangeAKind) {
  std::variant<int, std::string> value = "sev";
  Dispatch(value, Overloads{[](int& number) { number += 1; }, [](std::string& text) { text += "en"; }});
  EXPECT_EQ(std::get<std::string>(value), "seven");
}

struct Circle {};
struct Square {};

template <typename Visitor>
concept CanDispatchShapes = requires(const std::variant<Circle, Square>& value, Visitor visitor) {
  Dispatch(value, visitor);
};

TEST(Dispatch, AVisitorThatForgetsAKindIsRejectedByTheCompiler) {
  const Overloads circles_only{[](const Circle&) { return 1; }};
  const Overloads both{[](const Circle&) { return 1; }, [](const Square&) { return 2; }};
  static_assert(!CanDispatchShapes<decltype(circles_only)>);
  static_assert(CanDispatchShapes<decltype(both)>);
}

}  // namespace
}  // namespace tessera
