// Damage to files at rest, as disks do it.
#pragma once

#include <random>
#include <string>

namespace tessera {

// Flips one bit of one of the files in a folder and its subfolders. Returns false if there is no such file.
bool FlipBit(const std::string& folder, std::mt19937_64& random);

}  // namespace tessera
