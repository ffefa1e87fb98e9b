#include "client/coordinator/received_picture.h"

#include <gmock/gmock.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <filesystem>

#include "client/coordinator/coordinator_client.h"
#include "proto/jobs.grpc.pb.h"
#include "proto/shell/system.h"
#include "proto/wire/convert.h"
#include "tests/coordinator/store/temporary_dir.h"
#include "tests/small_disk.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(ReceivedPicture, IsHeldInMemoryUpToALimitAndThenInAFileWithoutAName) {
  for (const size_t held_max : {0, 999, 1000, 1001, 2000}) {
    const TemporaryDir folder;
    ReceivedPicture picture(folder.path(), held_max);
    ASSERT_TRUE(picture.Add(std::string(600, 'a')));
    ASSERT_TRUE(picture.Add(std::string(400, 'b')));
    EXPECT_EQ(picture.size(), 1000u);
    EXPECT_EQ(picture.is_in_memory(), held_max >= 1000);
    ReceivedPicture moved = std::move(picture);
    EXPECT_EQ(*moved.Bytes(), std::string(600, 'a') + std::string(400, 'b')) << held_max;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "nothing is left by whatever ends the client";
  }
}

TEST(ReceivedPicture, WithoutBytesIsEmpty) {
  ReceivedPicture picture("/nowhere");
  EXPECT_EQ(*picture.Bytes(), "");
}

TEST(ReceivedPicture, NamesTheFolderThatCannotTakeIt) {
  ReceivedPicture nowhere("/nowhere", 10);
  EXPECT_THAT(nowhere.Add(std::string(11, 'x')).error().message, HasSubstr("/nowhere"));
  const TemporaryDir folder;
  const SmallDisk disk(folder / "disk");
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  disk.Fill();
  ReceivedPicture picture(folder / "disk", 10);
  EXPECT_THAT(picture.Add(std::string(1 << 20, 'x')).error().message,
              testing::AllOf(HasSubstr(folder / "disk"), HasSubstr("No space left")));
}

// Sends pictures of any size.
class PictureSender final : public proto::Jobs::Service {
 public:
  PictureSender(const std::string& target, std::string piece, int pieces)
      : piece_(std::move(piece)), pieces_(pieces) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(target, grpc::InsecureServerCredentials());
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~PictureSender() override { server_->Shutdown(); }
  grpc::Status Health(grpc::ServerContext*, const proto::HealthRequest*,
                      proto::HealthAnswer* answer) override {
    answer->set_software_version(kSoftwareVersion);
    answer->set_protocol(kProtocolVersion);
    answer->set_farm(WriteFarmId(FarmId{1, 2}));
    return grpc::Status::OK;
  }
  grpc::Status FetchPicture(grpc::ServerContext*, const proto::FetchRequest*,
                            grpc::ServerWriter<proto::PictureChunk>* writer) override {
    std::string all;
    for (int i = 0; i < pieces_; ++i) all += piece_;
    proto::PictureChunk chunk;
    chunk.set_size(all.size());
    chunk.set_digest(WriteDigest(Sha256(all)));
    all = {};
    for (int i = 0; i < pieces_; ++i) {
      chunk.set_data(piece_);
      if (!writer->Write(chunk)) break;
    }
    return grpc::Status::OK;
  }

 private:
  const std::string piece_;
  const int pieces_;
  std::unique_ptr<grpc::Server> server_;
};

TEST(ReceivedPicture, ALargeOneArrivesWholeWithoutBeingHeldInMemory) {
  const TemporaryDir folder;
  const auto address = ParseAddress("unix:" + (folder / "socket"), "test");
  const int pieces = static_cast<int>(kPictureHeldMax >> 20) + 3;
  const PictureSender sender(address->Target(), std::string(1 << 20, 'x'), pieces);
  const auto client = CoordinatorClient::Connect(*address, {}, {});
  ASSERT_TRUE(client) << client.error().message;
  auto picture = (*client)->FetchPicture(JobId{1}, 0, false, folder.path());
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_FALSE(picture->is_in_memory());
  EXPECT_EQ(picture->size(), static_cast<uint64_t>(pieces) << 20);
  const auto refused = (*client)->FetchPicture(JobId{1}, 0, false, folder / "missing");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("missing")) << "which is not asked for again";
}

}  // namespace
}  // namespace tessera
