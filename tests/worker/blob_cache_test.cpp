#include "worker/blob_cache.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace tessera {
namespace {

namespace fs = std::filesystem;

class BlobCacheTest : public testing::Test {
 protected:
  BlobCacheTest() {
    folder_ = testing::TempDir() + "tessera-cache-XXXXXX";
    EXPECT_NE(::mkdtemp(folder_.data()), nullptr);
  }
  ~BlobCacheTest() override { fs::remove_all(folder_); }
  fs::path FileOf(const Digest& digest) const {
    return fs::path(folder_) / digest.Hex().substr(0, 2) / digest.Hex();
  }
  const std::string& folder() const { return folder_; }
  uint64_t BytesOnDisk() const {
    uint64_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      bytes += entry.is_regular_file() ? entry.file_size() : 0;
    return bytes;
  }

 private:
  std::string folder_;
};

constexpr uint64_t kPlenty = 1 << 20;

TEST_F(BlobCacheTest, GivesBackWhatWasPutAlsoToTheNextProcess) {
  const std::string bytes = "some bytes";
  {
    BlobCache cache(folder(), kPlenty);
    EXPECT_FALSE(cache.Get(Sha256(bytes)));
    EXPECT_TRUE(cache.Put(Sha256(bytes), bytes));
  }
  BlobCache cache(folder(), kPlenty);
  EXPECT_EQ(cache.Get(Sha256(bytes)), bytes);
}

TEST_F(BlobCacheTest, RemovesWhatAKilledProcessLeftHalfWritten) {
  const pid_t dead = ::fork();
  if (dead == 0) ::_exit(0);
  ASSERT_EQ(::waitpid(dead, nullptr, 0), dead);
  const std::string of_the_dead = folder() + "/ab.tmp-" + std::to_string(dead) + "-0";
  const std::string of_the_living = folder() + "/ab.tmp-" + std::to_string(::getpid()) + "-0";
  for (const std::string& name : {of_the_dead, of_the_living}) std::ofstream(name) << "half";
  const BlobCache cache(folder(), kPlenty);
  EXPECT_FALSE(fs::exists(of_the_dead));
  EXPECT_TRUE(fs::exists(of_the_living));
}

TEST_F(BlobCacheTest, NeverGivesDamagedBytes) {
  const std::string bytes = "some bytes";
  BlobCache cache(folder(), kPlenty);
  EXPECT_TRUE(cache.Put(Sha256(bytes), bytes));
  for (const char* damaged : {"some bytez", "some byte", ""}) {
    std::ofstream(FileOf(Sha256(bytes))) << damaged;
    EXPECT_FALSE(cache.Get(Sha256(bytes)));
    EXPECT_FALSE(fs::exists(FileOf(Sha256(bytes))));
    EXPECT_TRUE(cache.Put(Sha256(bytes), bytes));
    EXPECT_EQ(cache.Get(Sha256(bytes)), bytes);
  }
}

TEST_F(BlobCacheTest, GivesUpTheLongestUnusedBeyondItsSize) {
  BlobCache cache(folder(), 10'000);
  std::vector<Digest> digests;
  const auto put = [&](char letter) {
    const std::string bytes(1000, letter);
    EXPECT_TRUE(cache.Put(Sha256(bytes), bytes));
    digests.push_back(Sha256(bytes));
    // Times of files may be coarse: set them apart.
    fs::last_write_time(FileOf(digests.back()),
                        fs::file_time_type::clock::now() - std::chrono::hours(100 - digests.size()));
  };
  for (char letter = 'a'; letter < 'k'; ++letter) put(letter);
  EXPECT_TRUE(cache.Get(digests[0]));  // now the latest used
  put('k');
  EXPECT_LE(BytesOnDisk(), 10'000u);
  EXPECT_TRUE(cache.Get(digests[0]));
  EXPECT_FALSE(cache.Get(digests[1]));
  EXPECT_TRUE(cache.Get(digests.back()));
}

TEST_F(BlobCacheTest, DoesWithoutWhatIsLargerThanTheCache) {
  BlobCache cache(folder(), 100);
  const std::string bytes(1000, 'x');
  EXPECT_TRUE(cache.Put(Sha256(bytes), bytes));
  EXPECT_EQ(BytesOnDisk(), 0u);
}

TEST_F(BlobCacheTest, AFolderThatCannotBeMadeIsRefused) {
  EXPECT_TRUE(BlobCache::Prepare(folder() + "/new/deep"));
  EXPECT_FALSE(BlobCache::Prepare("/proc/nothing"));
}

TEST_F(BlobCacheTest, ADownloadGoesOnWhereAFormerProcessStopped) {
  const std::string bytes(5000, 'x');
  {
    BlobCache cache(folder(), kPlenty);
    const auto incoming = cache.Begin(Sha256(bytes), bytes.size());
    ASSERT_TRUE((*incoming)->Add(bytes.substr(0, 3000)));
    EXPECT_FALSE(cache.Has(Sha256(bytes), bytes.size()));
  }
  BlobCache cache(folder(), kPlenty);
  {
    const auto incoming = cache.Begin(Sha256(bytes), bytes.size());
    EXPECT_EQ((*incoming)->size(), 3000u);
    EXPECT_EQ(*cache.Begin(Sha256(bytes), bytes.size()), nullptr) << "one fetches, the others wait";
    ASSERT_TRUE((*incoming)->Add(bytes.substr(3000)));
    ASSERT_TRUE((*incoming)->Finish());
  }
  EXPECT_TRUE(cache.Has(Sha256(bytes), bytes.size()));
  EXPECT_EQ(cache.Get(Sha256(bytes)), bytes);
  EXPECT_EQ(BytesOnDisk(), bytes.size());
}

TEST_F(BlobCacheTest, ADownloadWithOtherBytesLeavesNothing) {
  BlobCache cache(folder(), kPlenty);
  const auto incoming = cache.Begin(Sha256("abc"), 3);
  ASSERT_TRUE((*incoming)->Add("abd"));
  EXPECT_FALSE((*incoming)->Finish());
  EXPECT_FALSE(cache.Has(Sha256("abc"), 3));
  EXPECT_EQ(BytesOnDisk(), 0u);
}

}  // namespace
}  // namespace tessera
