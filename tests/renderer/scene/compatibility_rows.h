// Every kind of the scene language with the parameters that pbrt-v4 gives it, for the table of what Tessera
// does with them (renderer/PBRT.md).
#pragma once

#include <span>
#include <string_view>

namespace tessera {

// Parameters are "type name=values", separated by ";". Values are as scene files write them, without
// brackets.
struct KindRow {
  std::string_view family;  // as in SceneLanguageKinds()
  std::string_view kind;
  std::string_view base;        // parameters without which the kind is refused
  std::string_view parameters;  // each of them is tried by itself
};

std::span<const KindRow> KindRows();

}  // namespace tessera
