// Computes the table of sRGB albedos that is built into the renderer: main TABLE_FILE. Part of the build.
#include <cstdio>
#include <fstream>

#include "renderer/color/rgb_table.h"

int main(int argument_count, char** arguments) {
  if (argument_count != 2) {
    std::fprintf(stderr, "usage: %s TABLE_FILE\n", arguments[0]);
    return 2;
  }
  const std::vector<float> table = tessera::BuildRgbTable(tessera::SigmoidSolver(tessera::kSrgbPrimaries));
  std::ofstream file(arguments[1], std::ios::binary);
  file.write(reinterpret_cast<const char*>(table.data()),
             static_cast<std::streamsize>(table.size() * sizeof(float)));
  file.close();
  if (!file) std::fprintf(stderr, "%s cannot be written\n", arguments[1]);
  return file ? 0 : 1;
}
