// Blobs up and down.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <list>
#include <thread>

#include "coordinator/blob_service.h"
#include "proto/blobs/blob_store.h"
#include "tests/coordinator/services_fixture.h"

namespace tessera {
namespace {

using grpc::StatusCode;

TEST_F(Services, BlobsAreKeptOnlyIfSizeAndDigestMatch) {
  const std::string bytes(5000, 'x');
  EXPECT_EQ(Upload(bytes, Sha256("other"), bytes.size()).error_code(), StatusCode::DATA_LOSS);
  EXPECT_EQ(Upload(bytes, Sha256(bytes), 4999).error_code(), StatusCode::DATA_LOSS);
  EXPECT_EQ(Upload(bytes, Sha256(bytes), 6000).error_code(), StatusCode::DATA_LOSS);
  proto::FindMissingRequest request;
  request.add_digests(WriteDigest(Sha256(bytes)));
  proto::FindMissingAnswer answer;
  ASSERT_TRUE(Call(*blobs, &proto::Blobs::Stub::FindMissing, request, answer).ok());
  EXPECT_EQ(answer.missing_size(), 1);
  EXPECT_TRUE(Upload(bytes, Sha256(bytes), bytes.size()).ok());
  EXPECT_TRUE(Upload(bytes, Sha256(bytes), bytes.size()).ok()) << "a copy is welcome";
  ASSERT_TRUE(Call(*blobs, &proto::Blobs::Stub::FindMissing, request, answer).ok());
  EXPECT_EQ(answer.missing_size(), 0);
}

TEST_F(Services, AnUploadThatWasCutShortIsResumedWhereItStopped) {
  const std::string bytes(3'000'000, 'x');
  EXPECT_EQ(Upload(bytes.substr(0, 2'000'000), Sha256(bytes), bytes.size()).error_code(),
            StatusCode::DATA_LOSS);
  proto::FindMissingRequest request;
  request.add_digests(WriteDigest(Sha256(bytes)));
  proto::FindMissingAnswer answer;
  ASSERT_TRUE(Call(*blobs, &proto::Blobs::Stub::FindMissing, request, answer).ok());
  ASSERT_EQ(answer.held_size(), 1);
  EXPECT_EQ(answer.held(0), 2'000'000u);
  const auto send_rest = [&](uint64_t offset) {
    grpc::ClientContext context;
    proto::UploadAnswer uploaded;
    const auto writer = blobs->Upload(&context, &uploaded);
    proto::UploadChunk chunk;
    chunk.set_digest(WriteDigest(Sha256(bytes)));
    chunk.set_size(bytes.size());
    chunk.set_offset(offset);
    chunk.set_data(bytes.substr(offset, 1'000'000));
    writer->Write(chunk);
    writer->WritesDone();
    return writer->Finish();
  };
  EXPECT_EQ(send_rest(2'500'000).error_code(), StatusCode::UNAVAILABLE) << "fewer bytes have arrived";
  EXPECT_TRUE(send_rest(2'000'000).ok());
  EXPECT_TRUE(coordinator->blobs().Has(Sha256(bytes)));
}

TEST_F(Services, AnUploadOfChunksWithoutDataIsRefused) {
  grpc::ClientContext context;
  proto::UploadAnswer answer;
  const auto writer = blobs->Upload(&context, &answer);
  proto::UploadChunk chunk;
  chunk.set_digest(WriteDigest(Sha256("x")));
  chunk.set_size(1);
  // Until the coordinator ends the call.
  while (writer->Write(chunk)) chunk.Clear();
  const grpc::Status status = writer->Finish();
  EXPECT_EQ(status.error_code(), StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(status.error_message(), "message refused: a chunk without data");
}

TEST_F(Services, BlobsAreDownloadedFromAnyOffset) {
  std::string bytes(3'000'000, '\0');
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7 % 251);
  ASSERT_TRUE(coordinator->blobs().Write(Sha256(bytes), bytes));
  for (const uint64_t offset : {uint64_t{0}, uint64_t{1'234'567}, uint64_t{3'000'000}}) {
    grpc::ClientContext context;
    proto::DownloadRequest request;
    request.set_digest(WriteDigest(Sha256(bytes)));
    request.set_offset(offset);
    const auto reader = blobs->Download(&context, request);
    std::string received;
    proto::DownloadChunk chunk;
    while (reader->Read(&chunk)) received += chunk.data();
    EXPECT_TRUE(reader->Finish().ok());
    EXPECT_TRUE(received == bytes.substr(offset)) << offset;
  }
  const std::pair<uint64_t, StatusCode> table[] = {{3'000'001, StatusCode::OUT_OF_RANGE},
                                                   {0, StatusCode::NOT_FOUND}};
  for (const auto& [offset, code] : table) {
    grpc::ClientContext context;
    proto::DownloadRequest request;
    request.set_digest(WriteDigest(Sha256(offset > 0 ? bytes : "no such blob")));
    request.set_offset(offset);
    const auto reader = blobs->Download(&context, request);
    proto::DownloadChunk chunk;
    EXPECT_FALSE(reader->Read(&chunk));
    EXPECT_EQ(reader->Finish().error_code(), code);
  }
}

// Downloads that nobody reads.
TEST_F(Services, TransfersBeyondTheLimitAreToldToTryAgain) {
  // More than the buffers of a connection take.
  const std::string blob(64 << 20, 'x');
  const auto upload = coordinator->blobs().Begin(Sha256(blob), blob.size(), 0);
  ASSERT_TRUE(upload && (*upload)->Add(blob) && (*upload)->Finish());
  proto::DownloadRequest request;
  request.set_digest(WriteDigest(Sha256(blob)));
  struct Unread {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReader<proto::DownloadChunk>> reader;
  };
  std::list<Unread> unread;
  proto::DownloadChunk chunk;
  for (int i = 0; i < kDownloadPlaces.own; ++i) {
    Unread& each = unread.emplace_back();
    each.reader = blobs->Download(&each.context, request);
    ASSERT_TRUE(each.reader->Read(&chunk));
  }
  const auto next = [&] {
    grpc::ClientContext context;
    const auto reader = blobs->Download(&context, request);
    while (reader->Read(&chunk)) {
    }
    return reader->Finish().error_code();
  };
  EXPECT_EQ(next(), grpc::StatusCode::UNAVAILABLE);
  for (Unread& each : unread) {
    each.context.TryCancel();
    each.reader->Finish();
  }
  const auto end = std::chrono::steady_clock::now() + kPatience;
  auto code = next();
  while (code != grpc::StatusCode::OK && std::chrono::steady_clock::now() < end) code = next();
  EXPECT_EQ(code, grpc::StatusCode::OK);
}

TEST_F(Services, ADamagedBlobIsAskedForAgainAndNeverSent) {
  const std::string bytes(5000, 'x');
  const Digest digest = Sha256(bytes);
  const auto damage = [&] { std::ofstream(coordinator->blobs().Path(digest), std::ios::app) << "y"; };
  const auto missing = [&] {
    proto::FindMissingRequest request;
    request.add_digests(WriteDigest(digest));
    proto::FindMissingAnswer answer;
    EXPECT_TRUE(Call(*blobs, &proto::Blobs::Stub::FindMissing, request, answer).ok());
    return answer.missing_size();
  };
  ASSERT_TRUE(Upload(bytes, digest, bytes.size()).ok());
  EXPECT_EQ(missing(), 0);
  damage();
  EXPECT_EQ(missing(), 1);
  ASSERT_TRUE(Upload(bytes, digest, bytes.size()).ok());
  EXPECT_EQ(missing(), 0);
  damage();
  grpc::ClientContext context;
  proto::DownloadRequest request;
  request.set_digest(WriteDigest(digest));
  const auto reader = blobs->Download(&context, request);
  proto::DownloadChunk chunk;
  EXPECT_FALSE(reader->Read(&chunk));
  EXPECT_EQ(reader->Finish().error_code(), StatusCode::NOT_FOUND);
  EXPECT_EQ(missing(), 1);
}

TEST_F(Services, LargeUploadsThatGoOnDelayNoOtherCall) {
  ASSERT_TRUE(WaitForConnection(*channel, kPatience));
  constexpr uint64_t kArrived = uint64_t{1} << 29;
  constexpr int kUploads = 4;
  std::vector<std::thread> uploads;
  std::atomic<int> running = kUploads;
  for (int i = 0; i < kUploads; ++i) {
    const Digest digest = Sha256(std::to_string(i));
    const std::string path = folder / ("data/blobs/incoming/" + digest.Hex());
    std::ofstream(path).flush();
    std::filesystem::resize_file(path, kArrived);
    uploads.emplace_back([&, digest] {
      grpc::ClientContext context;
      proto::UploadAnswer answer;
      const auto writer = blobs->Upload(&context, &answer);
      proto::UploadChunk chunk;
      chunk.set_digest(WriteDigest(digest));
      chunk.set_size(kArrived + 1);
      chunk.set_offset(kArrived);
      chunk.set_data("x");
      writer->Write(chunk);
      writer->WritesDone();
      EXPECT_EQ(writer->Finish().error_code(), StatusCode::UNAVAILABLE) << "zeros do not have the digest";
      --running;
    });
  }
  const auto start = std::chrono::steady_clock::now();
  auto slowest = std::chrono::steady_clock::duration::zero();
  while (running > 0) {
    const auto asked = std::chrono::steady_clock::now();
    proto::HealthAnswer answer;
    EXPECT_TRUE(Call(*jobs, &proto::Jobs::Stub::Health, proto::HealthRequest(), answer).ok());
    slowest = std::max(slowest, std::chrono::steady_clock::now() - asked);
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_LT(slowest, (std::chrono::steady_clock::now() - start) / 4);
  for (std::thread& upload : uploads) upload.join();
}

}  // namespace
}  // namespace tessera
