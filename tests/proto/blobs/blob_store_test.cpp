#include "proto/blobs/blob_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "proto/terms.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/proto/blobs/origin_store.h"

namespace tessera {
namespace {

using testing::HasSubstr;

int FilesIn(const std::string& path) {
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
    count += entry.is_regular_file();
  return count;
}

TEST(BlobStore, ReadsWhatWasWritten) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs");
  const Digest digest = Sha256("some bytes");
  EXPECT_FALSE(store->Has(digest));
  ASSERT_TRUE(store->Write(digest, "some bytes"));
  EXPECT_EQ(store->Size(digest), 10u);
  EXPECT_EQ(*store->Read(digest, 100), "some bytes");
  EXPECT_FALSE(store->Read(digest, 9)) << "more than the reader wants";
  ASSERT_TRUE(store->Write(Sha256(""), ""));
  EXPECT_EQ(*store->Read(Sha256(""), 0), "");
}

TEST(BlobStore, ABlobThatArrivesInPiecesAppearsOnceItIsWhole) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs");
  const Digest digest = Sha256("abcdef");
  {
    auto upload = store->Begin(digest, 6);
    ASSERT_TRUE((*upload)->Add("abc"));
    EXPECT_FALSE(store->Has(digest));
    ASSERT_TRUE((*upload)->Add("def"));
    EXPECT_FALSE(store->Has(digest));
    ASSERT_TRUE((*upload)->Finish());
    EXPECT_TRUE(store->Has(digest));
  }
  EXPECT_EQ(FilesIn(directory.path()), 1);
}

TEST(BlobStore, WrongBytesAreRefusedAndLeaveNothing) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs");
  const Digest digest = Sha256("abc");
  const struct {
    const char* bytes;
    uint64_t size;
    const char* error;
  } table[] = {{"abd", 3, "SHA-256 mismatch"}, {"ab", 3, "2 bytes instead of 3"}, {"abcd", 3, "more bytes"}};
  for (const auto& row : table) {
    auto upload = store->Begin(digest, row.size);
    const auto added = (*upload)->Add(row.bytes);
    const auto finished = added ? (*upload)->Finish() : added;
    ASSERT_FALSE(finished) << row.bytes;
    EXPECT_EQ(finished.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(finished.error().message, HasSubstr(row.error));
  }
  EXPECT_FALSE(store->Has(digest));
  EXPECT_EQ(FilesIn(directory.path()), 0);
  EXPECT_FALSE(store->Begin(digest, kBlobBytesMax + 1));
}

TEST(BlobStore, IncomingFilesThatCannotBeResumedAreRemoved) {
  const TemporaryDir directory;
  ASSERT_TRUE(OpenOrigin(directory / "blobs"));
  std::ofstream(directory / "blobs/incoming/left.a1b2c3") << "x";
  ASSERT_TRUE(OpenOrigin(directory / "blobs"));
  EXPECT_EQ(FilesIn(directory.path()), 0);
}

TEST(BlobStore, ACorruptBlobIsDetectedWhenRead) {
  const TemporaryDir directory;
  const auto store = OpenOrigin(directory / "blobs");
  const Digest digest = Sha256("abc");
  ASSERT_TRUE(store->Write(digest, "abc"));
  std::ofstream(store->Path(digest)) << "abd";
  EXPECT_THAT(store->Read(digest, 100).error().message, HasSubstr("corrupt (SHA-256 mismatch)"));
}

}  // namespace
}  // namespace tessera
