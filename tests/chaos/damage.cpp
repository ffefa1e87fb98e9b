#include "tests/chaos/damage.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

namespace tessera {

bool FlipBit(const std::string& folder, std::mt19937_64& random) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code gone;
    if (it->is_regular_file(gone) && it->file_size(gone) > 0 && !gone) files.push_back(it->path().string());
  }
  if (files.empty()) return false;
  std::ranges::sort(files);
  const std::string& path = files[std::uniform_int_distribution<size_t>(0, files.size() - 1)(random)];
  const uint64_t bits = 8 * fs::file_size(path);
  const uint64_t bit = std::uniform_int_distribution<uint64_t>(0, bits - 1)(random);
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(static_cast<std::streamoff>(bit / 8));
  const int byte = file.get();
  file.seekp(static_cast<std::streamoff>(bit / 8));
  file.put(static_cast<char>(byte ^ (1 << (bit % 8))));
  return true;
}

}  // namespace tessera
