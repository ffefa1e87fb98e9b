// The options of a scene: settings of the renderer as a whole.
#pragma once

#include <string_view>

#include "renderer/description/kind_table.h"

namespace tessera {

// By name, lower case without '-' and '_'. The reader is the type of the value ("bool", "integer", "float" or
// "string"). Mapped ones are ignored, with a warning unless their value is false.
KindTable<std::string_view> OptionKinds();

}  // namespace tessera
