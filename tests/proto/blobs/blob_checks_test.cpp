// Blobs that are damaged after they were stored, and uploads that go on.
#include "proto/blobs/blob_checks.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "proto/blobs/blob_store.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/proto/blobs/origin_store.h"

namespace tessera {
namespace {

using Presence = BlobStore::Presence;

void FlipBit(const std::string& path, std::streamoff at) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(at);
  const int byte = file.get();
  file.seekp(at);
  file.put(static_cast<char>(byte ^ 1));
}

const std::string kBlob(100'000, 'b');
const Digest kBlobDigest = Sha256(kBlob);

TEST(BlobChecks, ABlobThatWasDamagedIsRemovedWhenItIsUsedNext) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs");
  ASSERT_TRUE(store->Write(kBlobDigest, kBlob));
  EXPECT_EQ(store->Look(kBlobDigest), Presence::kIntact) << "it was hashed when it arrived";
  FlipBit(store->Path(kBlobDigest), 50'000);
  EXPECT_EQ(store->Look(kBlobDigest), Presence::kUnknown);
  EXPECT_EQ(store->UseVerified(kBlobDigest), std::nullopt);
  EXPECT_EQ(store->Look(kBlobDigest), Presence::kMissing) << "so that it is asked for again";
  EXPECT_EQ(store->bytes(), 0u);
  ASSERT_TRUE(store->Write(kBlobDigest, kBlob));
  EXPECT_EQ(store->UseVerified(kBlobDigest), kBlob.size());
}

TEST(BlobChecks, ABlobThatWasCutIsRemoved) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs");
  ASSERT_TRUE(store->Write(kBlobDigest, kBlob));
  std::filesystem::resize_file(store->Path(kBlobDigest), 10);
  EXPECT_EQ(store->UseVerified(kBlobDigest), std::nullopt);
  EXPECT_EQ(store->Look(kBlobDigest), Presence::kMissing);
}

TEST(BlobChecks, EveryBlobIsReadOnceAfterAStart) {
  const TemporaryDir directory;
  ASSERT_TRUE(OpenOrigin(directory / "blobs")->Write(kBlobDigest, kBlob));
  const auto store = OpenOrigin(directory / "blobs");
  EXPECT_EQ(store->Look(kBlobDigest), Presence::kUnknown);
  EXPECT_EQ(store->UseVerified(kBlobDigest), kBlob.size());
  for (int use = 0; use < 3; ++use)
    EXPECT_EQ(store->Look(kBlobDigest), Presence::kIntact) << "uses are not writes";
}

TEST(BlobChecks, ASuspectedBlobIsReadAgain) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs");
  ASSERT_TRUE(store->Write(kBlobDigest, kBlob));
  store->Suspect(kBlobDigest);
  EXPECT_EQ(store->Look(kBlobDigest), Presence::kUnknown);
  EXPECT_EQ(store->UseVerified(kBlobDigest), kBlob.size());
  EXPECT_EQ(store->Look(kBlobDigest), Presence::kIntact);
}

TEST(BlobChecks, TheHashOfAnUnfinishedFileIsKeptUntilTheFileIsWrittenTo) {
  const TemporaryDir directory;
  const std::string path = directory / "file";
  std::ofstream(path) << "abc";
  BlobChecks checks;
  auto hash = std::make_unique<Sha256Stream>();
  hash->Add("abc");
  checks.KeepHash(kBlobDigest, *FileStamp::Of(path), std::move(hash));
  hash = checks.TakeHash(kBlobDigest, *FileStamp::Of(path));
  ASSERT_NE(hash, nullptr);
  EXPECT_EQ(checks.TakeHash(kBlobDigest, *FileStamp::Of(path)), nullptr) << "once";
  checks.KeepHash(kBlobDigest, *FileStamp::Of(path), std::move(hash));
  std::ofstream(path, std::ios::app) << "d";
  EXPECT_EQ(checks.TakeHash(kBlobDigest, *FileStamp::Of(path)), nullptr);
}

}  // namespace
}  // namespace tessera
