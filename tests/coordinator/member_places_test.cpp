// No member takes all places for transfers and pictures.
#include "coordinator/member_places.h"

#include <list>

#include "coordinator/blob_service.h"
#include "tests/coordinator/members_fixture.h"

namespace tessera {
namespace {

using grpc::StatusCode;
using testing::HasSubstr;

Principal Member(uint64_t id) {
  Principal caller;
  caller.role = Role::kUser;
  caller.member = MemberId{id};
  caller.name = "m" + std::to_string(id);
  return caller;
}

TEST(MemberPlaces, AMemberTakesNoMoreThanItsPartAndGivesPlacesBack) {
  MemberPlaces places({3, 2}, "cooks are at work");
  auto first = places.Take(Member(1));
  const auto second = places.Take(Member(1));
  ASSERT_TRUE(first && second);
  const auto refused = places.Take(Member(1));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInterrupted);
  EXPECT_EQ(refused.error().message, "too many cooks are at work for user \"m1\"");
  auto other = places.Take(Member(2));
  ASSERT_TRUE(other);
  const auto full = places.Take(Member(2));
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().message, "too many cooks are at work");
  MemberPlaces::Place moved = std::move(*first);
  EXPECT_FALSE(places.Take(Member(3))) << "it has moved, not ended";
  moved = {};
  EXPECT_TRUE(places.Take(Member(1)));
  EXPECT_TRUE(places.Take(Member(3))) << "a place that nobody keeps is free";
}

class PlacesOfMembers : public ServicesForMembers {
 protected:
  struct Silent {
    grpc::ClientContext context;
    proto::UploadAnswer answer;
    std::unique_ptr<grpc::ClientWriter<proto::UploadChunk>> writer;
  };
  // Begins uploads that send nothing more, as the caller of the fixture.
  void BeginUploads(std::list<Silent>& silent, int count) {
    for (int i = 0; i < count; ++i) {
      Silent& each = silent.emplace_back();
      each.writer = blobs->Upload(&each.context, &each.answer);
      proto::UploadChunk chunk;
      chunk.set_size(100);
      chunk.set_digest(WriteDigest(Sha256(std::to_string(silent.size()))));
      each.writer->Write(chunk);
    }
  }
  static void End(std::list<Silent>& silent) {
    for (Silent& each : silent) {
      each.context.TryCancel();
      each.writer->Finish();
    }
  }
  grpc::Status UploadOf(const std::string& bytes) { return Upload(bytes, Sha256(bytes), bytes.size()); }
  grpc::Status DownloadOf(const std::string& bytes) {
    grpc::ClientContext context;
    proto::DownloadRequest request;
    request.set_digest(WriteDigest(Sha256(bytes)));
    const auto reader = blobs->Download(&context, request);
    proto::DownloadChunk chunk;
    while (reader->Read(&chunk)) {
    }
    return reader->Finish();
  }
};

TEST_F(PlacesOfMembers, UploadsOfOneMemberLeavePlacesToOthers) {
  const JoinedFarm ada = Join(Role::kUser, "ada"), bob = Join(Role::kUser, "bob");
  std::list<Silent> silent;
  CallAs(ada);
  BeginUploads(silent, kUploadPlaces.own);
  // They take their places on threads of the coordinator.
  grpc::Status refused;
  for (int i = 0; refused.ok() && i < 1000; ++i) refused = UploadOf("more" + std::to_string(i));
  EXPECT_EQ(refused.error_code(), StatusCode::UNAVAILABLE);
  EXPECT_THAT(refused.error_message(), HasSubstr("too many transfers are running for user \"ada\""));
  CallAs(bob);
  EXPECT_TRUE(UploadOf("others").ok());
  CallAsLocalUser();
  EXPECT_TRUE(UploadOf("the owner's").ok());
  End(silent);
}

TEST_F(PlacesOfMembers, UploadsTakeNoPlacesOfDownloads) {
  const std::string scene = "a scene";
  ASSERT_TRUE(UploadOf(scene).ok());
  std::list<Silent> silent;
  for (int member = 0; member < kUploadPlaces.all / kUploadPlaces.own; ++member) {
    CallAs(Join(Role::kUser, "m" + std::to_string(member)));
    BeginUploads(silent, kUploadPlaces.own);
  }
  CallAsLocalUser();
  grpc::Status refused;
  for (int i = 0; refused.ok() && i < 1000; ++i) refused = UploadOf("more" + std::to_string(i));
  EXPECT_THAT(refused.error_message(), HasSubstr("too many transfers are running; try again"));
  EXPECT_TRUE(DownloadOf(scene).ok());
  End(silent);
}

}  // namespace
}  // namespace tessera
