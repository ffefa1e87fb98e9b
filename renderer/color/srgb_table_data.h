// The table of rgb_table.h for sRGB, computed when the program was built.
#pragma once

namespace tessera {

// kRgbTableFloats floats and one more.
const float* SrgbTable();

}  // namespace tessera
