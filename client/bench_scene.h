// The scene of `tessera bench`.
#pragma once

#include <string>

namespace tessera {

// Scores of the same version can be compared between machines. It changes with the scene.
constexpr int kBenchVersion = 1;

// 1,000 balls of all common materials on a floor, lit by the sky and a lamp: 320 x 180 pixels with 16
// samples. Reads no file.
std::string BenchScene();

}  // namespace tessera
