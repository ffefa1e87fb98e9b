// What scenes may ask for.
#pragma once

#include <vector>

#include "renderer/description/kind_table.h"

namespace tessera {

// Every kind of every family, with how far it is supported: for the help, `info` and the guide.
std::vector<KindList> SceneLanguageKinds();

}  // namespace tessera
