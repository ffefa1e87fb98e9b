// Blobs that are resumed, and what is evicted when there is no room.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

#include "proto/scene_package.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/proto/blobs/origin_store.h"

namespace tessera {
namespace {

using testing::HasSubstr;

std::string Bytes(char c, uint64_t size) {
  return std::string(size, c);
}

// Sets the last use of a blob back.
void Age(const BlobStore& store, const Digest& digest, std::chrono::minutes age) {
  std::filesystem::last_write_time(store.Path(digest), std::filesystem::file_time_type::clock::now() - age);
}

// Sends `part` bytes of a blob and stops.
void SendPart(const BlobStore& store, const std::string& bytes, uint64_t part) {
  auto upload = store.Begin(Sha256(bytes), bytes.size());
  ASSERT_TRUE(upload);
  ASSERT_TRUE((*upload)->Add(std::string_view(bytes).substr(0, part)));
}

TEST(BlobStore, ABlobIsResumedWhereItStoppedEvenAfterARestart) {
  const TemporaryDir directory;
  const std::string bytes = Bytes('a', 3 * kMega);
  SendPart(*OpenOrigin(directory / "blobs"), bytes, 2 * kMega);
  const auto store = OpenOrigin(directory / "blobs");
  EXPECT_EQ(store->Arrived(Sha256(bytes)), 2 * kMega);
  EXPECT_EQ(store->bytes(), 2 * kMega);
  {
    auto upload = store->Begin(Sha256(bytes), bytes.size(), 2 * kMega);
    ASSERT_TRUE(upload) << upload.error().message;
    ASSERT_TRUE((*upload)->Add(std::string_view(bytes).substr(2 * kMega)));
    ASSERT_TRUE((*upload)->Finish());
  }
  EXPECT_EQ(*store->Read(Sha256(bytes), bytes.size()), bytes);
  EXPECT_EQ(store->bytes(), bytes.size());
  EXPECT_EQ(store->Arrived(Sha256(bytes)), 0u);
}

TEST(BlobStore, ACorruptBeginningIsDiscardedAndSentAgain) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs");
  const std::string bytes = Bytes('a', 3 * kMega);
  SendPart(*store, bytes, 2 * kMega);
  std::ofstream(directory / ("blobs/incoming/" + Sha256(bytes).Hex())) << Bytes('b', 2 * kMega);
  {
    auto upload = store->Begin(Sha256(bytes), bytes.size(), 2 * kMega);
    ASSERT_TRUE((*upload)->Add(std::string_view(bytes).substr(2 * kMega)));
    const auto finished = (*upload)->Finish();
    ASSERT_FALSE(finished);
    EXPECT_EQ(finished.error().kind, ErrorKind::kInterrupted) << "worth another attempt";
  }
  EXPECT_EQ(store->Arrived(Sha256(bytes)), 0u);
  EXPECT_EQ(store->bytes(), 0u);
  EXPECT_TRUE(store->Write(Sha256(bytes), bytes));
}

TEST(BlobStore, TwoCopiesOfABlobThatArriveTogetherDoNotInterfere) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs");
  const std::string bytes = Bytes('a', 2 * kMega);
  auto first = store->Begin(Sha256(bytes), bytes.size());
  ASSERT_TRUE((*first)->Add(std::string_view(bytes).substr(0, kMega)));
  EXPECT_FALSE(store->Begin(Sha256(bytes), bytes.size(), kMega)) << "the other copy is arriving there";
  ASSERT_TRUE(store->Write(Sha256(bytes), bytes));
  ASSERT_TRUE((*first)->Add(std::string_view(bytes).substr(kMega)));
  ASSERT_TRUE((*first)->Finish());
  EXPECT_EQ(*store->Read(Sha256(bytes), bytes.size()), bytes);
  EXPECT_EQ(store->bytes(), bytes.size()) << "counted once";
}

TEST(BlobStore, AnOffsetBeyondWhatIsThereIsRefused) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs");
  EXPECT_EQ(store->Begin(Sha256("abc"), 3, 2).error().kind, ErrorKind::kInterrupted);
  EXPECT_EQ(store->Begin(Sha256("abc"), 3, 4).error().kind, ErrorKind::kBadInput);
  EXPECT_EQ(store->bytes(), 0u);
}

TEST(BlobStore, LeastRecentlyUsedBlobsAreEvictedFirstExceptThoseOfOpenJobs) {
  const TemporaryDir directory;
  auto store = OpenOrigin(directory / "blobs", 4 * kMega);
  const std::string needed = Bytes('n', kMega), old = Bytes('o', kMega), young = Bytes('y', kMega);
  ScenePackage package;
  package.files["scene.pbrt"] = {Sha256(needed), needed.size()};
  const std::string manifest = EncodeScenePackage(package);
  for (const std::string& bytes : {needed, old, young, manifest})
    ASSERT_TRUE(store->Write(Sha256(bytes), bytes));
  Age(*store, Sha256(manifest), std::chrono::hours(9));
  Age(*store, Sha256(needed), std::chrono::hours(8));
  Age(*store, Sha256(old), std::chrono::hours(2));
  Age(*store, Sha256(young), std::chrono::hours(1));
  store->Protect([&] { return std::optional(std::vector<Digest>{Sha256(manifest)}); });
  ASSERT_TRUE(store->Write(Sha256("x"), "x")) << "there is room";
  EXPECT_TRUE(store->Has(Sha256(old)));
  ASSERT_TRUE(store->Write(Sha256(Bytes('z', kMega)), Bytes('z', kMega)));
  EXPECT_FALSE(store->Has(Sha256(old)));
  EXPECT_TRUE(store->Has(Sha256(young)));
  EXPECT_TRUE(store->Has(Sha256(needed)));
  EXPECT_TRUE(store->Has(Sha256(manifest)));
}

TEST(BlobStore, TheLastUseSurvivesARestart) {
  const TemporaryDir directory;
  const std::string used = Bytes('u', kMega), unused = Bytes('n', kMega);
  {
    const auto store = OpenOrigin(directory / "blobs", 3 * kMega);
    ASSERT_TRUE(store->Write(Sha256(used), used));
    ASSERT_TRUE(store->Write(Sha256(unused), unused));
    Age(*store, Sha256(used), std::chrono::hours(3));
    Age(*store, Sha256(unused), std::chrono::hours(2));
    EXPECT_EQ(store->Use(Sha256(used)), used.size());
  }
  const auto store = OpenOrigin(directory / "blobs", 3 * kMega - 1);
  ASSERT_TRUE(store->Write(Sha256(Bytes('z', kMega)), Bytes('z', kMega)));
  EXPECT_TRUE(store->Has(Sha256(used)));
  EXPECT_FALSE(store->Has(Sha256(unused)));
}

TEST(BlobStore, WithoutRoomABlobIsRefusedAndNothingThatIsNeededIsEvicted) {
  const TemporaryDir directory;
  auto store = OpenOrigin(directory / "blobs", 2 * kMega);
  const std::string recent = Bytes('r', kMega), large = Bytes('l', 2 * kMega);
  ASSERT_TRUE(store->Write(Sha256(recent), recent));
  const auto refused = store->Begin(Sha256(large), large.size());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kFailed);
  EXPECT_THAT(refused.error().message, HasSubstr("--blobs-size"));
  EXPECT_TRUE(store->Has(Sha256(recent))) << "a client may be about to submit it";
  Age(*store, Sha256(recent), std::chrono::hours(1));
  store->Protect([] { return std::optional<std::vector<Digest>>(); });
  EXPECT_EQ(store->Begin(Sha256(large), large.size()).error().kind, ErrorKind::kInterrupted)
      << "nobody knows what is needed";
  EXPECT_TRUE(store->Has(Sha256(recent)));
}

TEST(BlobStore, UnusedBlobsAreEvictedWhenTheDiskIsFull) {
  const TemporaryDir directory;
  uint64_t blobs_max = 3 * kMega;  // what fits on the disk before the reserve is touched
  auto options = BlobStoreOptions::Origin(uint64_t{1} << 40);
  const std::string path = directory / "blobs";
  options.disk_space = [&](const std::string&) {
    uint64_t used = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
      if (entry.is_regular_file()) used += entry.file_size();
    }
    const uint64_t total = 40 * kMega, reserve = total / kReserveDivisor;
    return std::optional(DiskSpace{total, blobs_max + reserve - std::min(used, blobs_max + reserve)});
  };
  const auto store = BlobStore::Open(path, options);
  const std::string old = Bytes('o', kMega), recent = Bytes('r', kMega), next = Bytes('n', 2 * kMega);
  for (const std::string& bytes : {old, recent}) ASSERT_TRUE(store->Write(Sha256(bytes), bytes));
  Age(*store, Sha256(old), std::chrono::hours(24));
  ASSERT_TRUE(store->Write(Sha256(next), next));
  EXPECT_FALSE(store->Has(Sha256(old)));
  EXPECT_TRUE(store->Has(Sha256(recent)));
  const auto refused = store->Begin(Sha256(old), old.size());
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              testing::AllOf(HasSubstr(path), HasSubstr("its file system has"), HasSubstr("reserved")));

  Age(*store, Sha256(next), std::chrono::hours(1));
  store->FreeReserve();
  EXPECT_TRUE(store->Has(Sha256(next))) << "the reserve is there";
  blobs_max = 2 * kMega;  // others have written to the disk
  store->FreeReserve();
  EXPECT_FALSE(store->Has(Sha256(next)));
  EXPECT_TRUE(store->Has(Sha256(recent)));
}

TEST(BlobStore, BytesThatWereAnnouncedAndHaveNotArrivedCountOnTheDisk) {
  const TemporaryDir directory;
  auto options = BlobStoreOptions::Origin(uint64_t{1} << 40);
  options.disk_space = [](const std::string&) { return std::optional(DiskSpace{10 * kMega, 4 * kMega}); };
  const auto store = BlobStore::Open(directory / "blobs", options);
  {
    const auto first = store->Begin(Sha256("a"), 2 * kMega);
    ASSERT_TRUE(first);
    EXPECT_FALSE(store->Begin(Sha256("b"), 2 * kMega));
  }
  EXPECT_TRUE(store->Begin(Sha256("b"), 2 * kMega)) << "the first upload has ended";
}

TEST(BlobStore, AnnouncedSizesLeaveRoomForOthers) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs", 100 * kMega);
  std::vector<std::unique_ptr<BlobStore::Partial>> silent;
  for (const uint64_t size : {100, 80, 60, 40}) {
    auto upload = store->Begin(Sha256(std::to_string(size)), size * kMega);
    ASSERT_TRUE(upload) << size << " " << upload.error().message;
    ASSERT_TRUE((*upload)->Add("x"));
    silent.push_back(std::move(*upload));
  }
  EXPECT_EQ(store->bytes(), 64 * kMega);
  EXPECT_TRUE(store->Write(Sha256("small"), "small"));
  const auto refused = store->Begin(Sha256("large"), 90 * kMega);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInterrupted);
  EXPECT_THAT(refused.error().message, HasSubstr("are reserved for uploads that are running"));
  EXPECT_EQ(store->Begin(Sha256("large"), 101 * kMega).error().kind, ErrorKind::kFailed) << "it never fits";
  silent.clear();
  EXPECT_EQ(store->bytes(), 5u);
  EXPECT_TRUE(store->Begin(Sha256("large"), 90 * kMega));
}

TEST(BlobStore, ALargeBlobIsStoredWithRoomForNoMore) {
  const TemporaryDir directory;
  const std::string bytes = Bytes('l', 40 * kMega);
  const auto store = OpenOrigin(directory / "blobs", bytes.size());
  ASSERT_TRUE(store->Write(Sha256(bytes), bytes)) << "in one piece";
  EXPECT_EQ(store->bytes(), bytes.size());
  store->Remove(Sha256(bytes));
  auto upload = store->Begin(Sha256(bytes), bytes.size());
  for (uint64_t at = 0; at < bytes.size(); at += 3 * kMega)
    ASSERT_TRUE((*upload)->Add(std::string_view(bytes).substr(at, 3 * kMega)));
  ASSERT_TRUE((*upload)->Finish());
  EXPECT_EQ(store->bytes(), bytes.size());
}

TEST(BlobStore, AnUploadThatRunsOutOfRoomKeepsWhatHasArrived) {
  const TemporaryDir directory;
  const std::string bytes = Bytes('b', 24 * kMega);
  const auto store = OpenOrigin(directory / "blobs", 39 * kMega);
  std::unique_ptr<BlobStore::Partial> other;
  {
    auto upload = store->Begin(Sha256(bytes), bytes.size());
    ASSERT_TRUE((*upload)->Add(std::string_view(bytes).substr(0, 16 * kMega)));
    other = std::move(*store->Begin(Sha256("other"), 20 * kMega));
    const auto added = (*upload)->Add(std::string_view(bytes).substr(16 * kMega));
    ASSERT_FALSE(added);
    EXPECT_EQ(added.error().kind, ErrorKind::kInterrupted);
  }
  EXPECT_EQ(store->Arrived(Sha256(bytes)), 16 * kMega);
  other.reset();
  auto upload = store->Begin(Sha256(bytes), bytes.size(), 16 * kMega);
  ASSERT_TRUE(upload) << upload.error().message;
  ASSERT_TRUE((*upload)->Add(std::string_view(bytes).substr(16 * kMega)));
  ASSERT_TRUE((*upload)->Finish());
  EXPECT_EQ(store->bytes(), bytes.size());
}

TEST(BlobStore, TheJobsInUseAreAskedForWithoutALock) {
  const TemporaryDir directory;
  auto store = OpenOrigin(directory / "blobs", kMega);
  const std::string old = Bytes('o', kMega);
  ASSERT_TRUE(store->Write(Sha256(old), old));
  Age(*store, Sha256(old), std::chrono::hours(2));
  // The answer may take seconds, and others use the store meanwhile.
  store->Protect([&]() -> std::optional<std::vector<Digest>> {
    EXPECT_EQ(store->bytes(), kMega);
    EXPECT_TRUE(store->Begin(Sha256(""), 0));
    return std::vector<Digest>();
  });
  EXPECT_TRUE(store->Write(Sha256(Bytes('n', kMega)), Bytes('n', kMega)));
}

}  // namespace
}  // namespace tessera
