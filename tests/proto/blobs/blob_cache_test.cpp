// A blob store as a cache that several processes share.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "proto/blobs/blob_store.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/proto/blobs/origin_store.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

class BlobCache : public testing::Test {
 protected:
  BlobStore Open(uint64_t bytes_max = 100 * kMega) const {
    return *BlobStore::Open(folder_.path(), BlobStoreOptions::Cache(bytes_max));
  }
  uint64_t BytesOnDisk() const {
    uint64_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      bytes += entry.is_regular_file() ? entry.file_size() : 0;
    return bytes;
  }
  TemporaryDir folder_;
};

TEST_F(BlobCache, IsSharedWithTheNextProcess) {
  const std::string bytes = "some bytes";
  ASSERT_TRUE(Open().Write(Sha256(bytes), bytes));
  EXPECT_EQ(*Open().Read(Sha256(bytes), 100), bytes);
}

// Someone who could once write to the folder may have left links in it.
TEST_F(BlobCache, LinksAreNotFollowed) {
  const TemporaryDir elsewhere;
  const std::string bytes = "some bytes";
  const Digest digest = Sha256(bytes);
  std::ofstream(elsewhere / "precious") << "precious";
  const BlobStore cache = Open();
  const std::string incoming = folder_.path() + "/incoming/" + digest.Hex();
  fs::create_symlink(elsewhere / "precious", incoming);
  ASSERT_TRUE(cache.Write(digest, bytes));
  EXPECT_EQ(fs::file_size(elsewhere / "precious"), 8u);
  EXPECT_EQ(*cache.Read(digest, 100), bytes);
}

TEST_F(BlobCache, ALinkIsNoBlob) {
  const TemporaryDir elsewhere;
  const std::string bytes = "some bytes";
  std::ofstream(elsewhere / "file") << bytes;
  const BlobStore cache = Open();
  fs::create_directories(fs::path(cache.Path(Sha256(bytes))).parent_path());
  fs::create_symlink(elsewhere / "file", cache.Path(Sha256(bytes)));
  EXPECT_FALSE(cache.Has(Sha256(bytes)));
}

TEST_F(BlobCache, AFolderThatIsALinkIsRefused) {
  const TemporaryDir elsewhere;
  const std::string bytes = "some bytes";
  const BlobStore cache = Open();
  fs::create_directory_symlink(elsewhere.path(), fs::path(cache.Path(Sha256(bytes))).parent_path());
  EXPECT_FALSE(cache.Write(Sha256(bytes), bytes));
  EXPECT_TRUE(fs::is_empty(elsewhere.path()));
}

TEST_F(BlobCache, LeastRecentlyUsedBlobsAreEvictedFirst) {
  const BlobStore cache = Open(10'000);
  std::vector<Digest> digests;
  const auto write = [&](char letter) {
    const std::string bytes(1000, letter);
    EXPECT_TRUE(cache.Write(Sha256(bytes), bytes));
    digests.push_back(Sha256(bytes));
    // Times of files may be coarse: set them apart.
    fs::last_write_time(cache.Path(digests.back()),
                        fs::file_time_type::clock::now() - std::chrono::hours(100 - digests.size()));
  };
  for (char letter = 'a'; letter < 'k'; ++letter) write(letter);
  EXPECT_TRUE(cache.Use(digests[0]));
  write('k');
  EXPECT_LE(BytesOnDisk(), 10'000u);
  EXPECT_TRUE(cache.Has(digests[0]));
  EXPECT_FALSE(cache.Has(digests[1]));
  EXPECT_TRUE(cache.Has(digests.back()));
}

TEST_F(BlobCache, BlobsOfOtherProcessesCountWhenRoomIsNeeded) {
  const BlobStore one = Open(3 * kMega), other = Open(3 * kMega);
  for (const char letter : {'a', 'b'}) {
    const std::string bytes(kMega, letter);
    ASSERT_TRUE(other.Write(Sha256(bytes), bytes));
    fs::last_write_time(other.Path(Sha256(bytes)), fs::file_time_type::clock::now() - std::chrono::hours(1));
  }
  for (const char letter : {'c', 'd', 'e', 'f'}) {
    const std::string bytes(kMega, letter);
    ASSERT_TRUE(one.Write(Sha256(bytes), bytes));
  }
  EXPECT_LE(BytesOnDisk(), 3 * kMega);
}

TEST_F(BlobCache, ABlobLargerThanTheCacheIsRefused) {
  const auto written = Open(100).Write(Sha256(std::string(1000, 'x')), std::string(1000, 'x'));
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, testing::HasSubstr("the limit of --cache-size is 100"));
  EXPECT_EQ(BytesOnDisk(), 0u);
}

TEST_F(BlobCache, ACorruptBlobIsReplacedAfterItsRemoval) {
  const BlobStore cache = Open();
  const std::string bytes = "some bytes";
  for (const char* corrupt : {"some bytez", "some byte", ""}) {
    ASSERT_TRUE(cache.Write(Sha256(bytes), bytes));
    std::ofstream(cache.Path(Sha256(bytes))) << corrupt;
    EXPECT_FALSE(cache.Read(Sha256(bytes), 100));
    cache.Remove(Sha256(bytes));
    EXPECT_FALSE(cache.Has(Sha256(bytes)));
  }
  ASSERT_TRUE(cache.Write(Sha256(bytes), bytes));
  EXPECT_EQ(*cache.Read(Sha256(bytes), 100), bytes);
}

TEST_F(BlobCache, OneProcessReceivesABlobAndTheOthersWait) {
  const std::string bytes(3 * kMega, 'x');
  {
    const BlobStore cache = Open();
    const auto partial = cache.Resume(Sha256(bytes), bytes.size());
    ASSERT_TRUE((*partial)->Add(bytes.substr(0, 2 * kMega)));
    EXPECT_FALSE(cache.Has(Sha256(bytes)));
  }
  const BlobStore cache = Open(), other = Open();
  {
    const auto partial = cache.Resume(Sha256(bytes), bytes.size());
    EXPECT_EQ((*partial)->received(), 2 * kMega) << "what a former process received";
    EXPECT_EQ(*other.Resume(Sha256(bytes), bytes.size()), nullptr);
    ASSERT_TRUE((*partial)->Add(bytes.substr(2 * kMega)));
    ASSERT_TRUE((*partial)->Finish());
  }
  EXPECT_EQ(*other.Read(Sha256(bytes), bytes.size()), bytes);
  EXPECT_EQ(BytesOnDisk(), bytes.size());
}

TEST_F(BlobCache, OpeningRemovesOnlyTheIncomingFilesOfProcessesThatHaveEnded) {
  { const BlobStore cache = Open(); }
  const std::string dead = folder_ / "incoming/ab.dead", living = folder_ / "incoming/ab.live";
  std::ofstream(dead) << "half";
  const int file = ::open(living.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  ASSERT_EQ(::flock(file, LOCK_EX | LOCK_NB), 0);
  { const BlobStore cache = Open(); }
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(living));
  ::close(file);
}

TEST_F(BlobCache, AFolderThatCannotBeCreatedIsRefused) {
  EXPECT_TRUE(BlobStore::Open(folder_ / "new/deep", BlobStoreOptions::Cache(kMega)));
  EXPECT_FALSE(BlobStore::Open("/proc/nothing", BlobStoreOptions::Cache(kMega)));
}

TEST_F(BlobCache, AFolderOfIncomingFilesThatIsALinkIsRefused) {
  const TemporaryDir elsewhere;
  std::ofstream(elsewhere / "not.ours") << "precious";
  fs::create_directory_symlink(elsewhere.path(), folder_ / "incoming");
  const auto cache = BlobStore::Open(folder_.path(), BlobStoreOptions::Cache(kMega));
  ASSERT_FALSE(cache);
  EXPECT_EQ(cache.error().message, folder_ / "incoming: is not a folder");
  EXPECT_TRUE(fs::exists(elsewhere / "not.ours"));
}

// Someone who may rename the folder puts a link in its place.
TEST_F(BlobCache, AStoreStaysInItsFolderWhateverTakesItsName) {
  const TemporaryDir elsewhere;
  const std::string small = "some bytes", large(kMega, 'x');
  const BlobStore cache = *BlobStore::Open(folder_ / "cache", BlobStoreOptions::Cache(2 * kMega));
  ASSERT_TRUE(cache.Write(Sha256(small), small));
  auto arriving = cache.Begin(Sha256(large), large.size());
  ASSERT_TRUE(arriving);
  fs::rename(folder_ / "cache", folder_ / "moved");
  fs::create_directory_symlink(elsewhere.path(), folder_ / "cache");
  std::ofstream(elsewhere / "precious") << std::string(10'000, 'p');
  fs::create_directory(elsewhere / "incoming");

  ASSERT_TRUE((*arriving)->Add(large) && (*arriving)->Finish());
  for (char fill = 'a'; fill < 'f'; ++fill) {  // evicts others
    const std::string bytes(kMega / 2, fill);
    ASSERT_TRUE(cache.Write(Sha256(bytes), bytes));
    EXPECT_EQ(*cache.Read(Sha256(bytes), kMega), bytes);
    EXPECT_TRUE(
        fs::exists(folder_ / ("moved/" + Sha256(bytes).Hex().substr(0, 2) + "/" + Sha256(bytes).Hex())));
  }
  EXPECT_FALSE(cache.Has(Sha256(small))) << "evicted";
  cache.Remove(Sha256(std::string(kMega / 2, 'e')));
  EXPECT_TRUE(fs::is_empty(elsewhere / "incoming"));
  EXPECT_EQ(fs::file_size(elsewhere / "precious"), 10'000u);
  EXPECT_EQ(std::distance(fs::directory_iterator(elsewhere.path()), {}), 2) << "nothing else is there";
}

TEST_F(BlobCache, ErrorsNameTheFolderAsTheUserDid) {
  const BlobStore cache = *BlobStore::Open(folder_ / "cache", BlobStoreOptions::Cache(kMega));
  const std::string bytes = "some bytes";
  ASSERT_TRUE(cache.Write(Sha256(bytes), bytes));
  const std::string path =
      folder_ / ("cache/" + Sha256(bytes).Hex().substr(0, 2) + "/" + Sha256(bytes).Hex());
  std::ofstream(path) << "other bytes";
  EXPECT_EQ(cache.Read(Sha256(bytes), 100).error().message, path + ": is corrupt (SHA-256 mismatch)");
  EXPECT_THAT(cache.Read(Sha256(bytes), 5).error().message, testing::StartsWith(path + ": holds 11 bytes"));
  EXPECT_THAT(cache.Begin(Sha256("x"), 2 * kMega).error().message, testing::StartsWith(folder_ / "cache:"));
}

}  // namespace
}  // namespace tessera
