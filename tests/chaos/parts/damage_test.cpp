#include "tests/chaos/damage.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace tessera {
namespace {

class Damage : public testing::Test {
 protected:
  Damage() {
    std::string path = "/tmp/tessera-damage-XXXXXX";
    folder_ = ::mkdtemp(path.data());
  }
  ~Damage() override { std::filesystem::remove_all(folder_); }
  void Write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories(std::filesystem::path(folder_ + "/" + name).parent_path());
    std::ofstream(folder_ + "/" + name, std::ios::binary) << bytes;
  }
  std::string Read(const std::string& name) const {
    std::ifstream file(folder_ + "/" + name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static int BitsThatDiffer(const std::string& a, const std::string& b) {
    EXPECT_EQ(a.size(), b.size());
    int bits = 0;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
      bits += std::popcount(static_cast<unsigned char>(a[i] ^ b[i]));
    return bits;
  }

  std::string folder_;
  std::mt19937_64 random_{1};
};

TEST_F(Damage, FlipsOneBitOfOneOfTheFiles) {
  const std::string one(1000, 'a'), other(10, 'b');
  Write("one", one);
  Write("sub/folder/other", other);
  Write("empty", "");
  int in_one = 0;
  for (int i = 0; i < 50; ++i) {
    const std::string one_before = Read("one"), other_before = Read("sub/folder/other");
    ASSERT_TRUE(FlipBit(folder_, random_));
    const int first = BitsThatDiffer(Read("one"), one_before);
    EXPECT_EQ(first + BitsThatDiffer(Read("sub/folder/other"), other_before), 1);
    in_one += first;
  }
  EXPECT_GT(in_one, 10);
  EXPECT_LT(in_one, 40);
}

TEST_F(Damage, AFolderWithoutFilesIsNotDamaged) {
  Write("sub/empty", "");
  EXPECT_FALSE(FlipBit(folder_, random_));
  EXPECT_FALSE(FlipBit(folder_ + "/missing", random_));
}

}  // namespace
}  // namespace tessera
