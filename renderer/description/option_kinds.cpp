#include "renderer/description/option_kinds.h"

namespace tessera {
namespace {

constexpr std::string_view kIgnored = "ignored";

constexpr Kind<std::string_view> kKinds[] = {
    {"disablepixeljitter", Support::kSupported, "bool"},
    {"disabletexturefiltering", Support::kSupported, "bool"},
    {"disablewavelengthjitter", Support::kSupported, "bool"},
    {"forcediffuse", Support::kSupported, "bool"},
    {"msereferenceimage", Support::kMapped, "string", kIgnored},
    {"msereferenceout", Support::kMapped, "string", kIgnored},
    {"displacementedgescale", Support::kSupported, "float"},
    {"seed", Support::kSupported, "integer"},
    // These change how pbrt works, not what it computes: whatever their value, they are satisfied.
    {"pixelstats", Support::kSupported, "bool"},
    {"rendercoordsys", Support::kSupported, "string"},
    {"wavefront", Support::kSupported, "bool"},
};

}  // namespace

KindTable<std::string_view> OptionKinds() {
  return {"option", kKinds};
}

}  // namespace tessera
