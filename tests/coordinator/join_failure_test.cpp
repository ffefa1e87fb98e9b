// Joining while the disk is full, and identities that are lost or exchanged.
#include <filesystem>

#include "tests/coordinator/members_fixture.h"
#include "tests/coordinator/no_file_grows.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

class JoinFailures : public ServicesForMembers {
 protected:
  // A start with the data directory as it is now.
  Result<std::unique_ptr<Coordinator>> Open(bool start_afresh = false) const {
    CoordinatorOptions options = OptionsOf(current_dir);
    options.start_afresh = start_afresh;
    return Coordinator::Start(options);
  }
  bool IsAnswered(const JoinedFarm& member) {
    CallAs(member);
    proto::ListAnswer answer;
    return Call(*jobs, &proto::Jobs::Stub::List, proto::ListRequest(), answer).ok();
  }
  size_t MembersListed() {
    CallAsLocalUser();
    proto::AccessAnswer answer;
    EXPECT_TRUE(Call(*access, &proto::Access::Stub::ListAccess, proto::AccessRequest(), answer).ok());
    size_t members = 0;
    for (const auto& each : answer.members()) members += each.revoked() ? 0 : 1;
    return members;
  }
  fs::path Identity() const { return fs::path(folder / current_dir) / "identity"; }
};

// Signing costs the coordinator more than looking at the token does.
TEST_F(JoinFailures, NothingIsSignedForATokenThatCannotBeUsed) {
  const JoinToken token = IssueToken(Role::kUser, "ada", 1);
  const auto ada = JoinFarm(token, "");
  ASSERT_TRUE(ada) << ada.error().message;
  proto::JoinRequest request;
  request.set_signing_request("this is none");
  proto::JoinAnswer answer;
  const auto stub = proto::Access::NewStub(ChannelOf(token, *ada));
  const grpc::Status refused = Call(*stub, &proto::Access::Stub::Join, request, answer);
  EXPECT_THAT(refused.error_message(), HasSubstr("the token has been used up"));
}

// The first attempt finds out that the disk takes nothing; by the second the coordinator knows.
TEST_F(JoinFailures, ACertificateThatCannotBeRecordedIsNotGivenAndItsTokenStaysUsable) {
  const JoinToken token = IssueToken(Role::kUser, "ada", 1);
  {
    const NoFileGrows full;
    for (int attempt = 0; attempt < 2; ++attempt) {
      const auto joined = JoinFarm(token, "");
      ASSERT_FALSE(joined);
      EXPECT_THAT(joined.error().message, HasSubstr("cannot write its data"));
    }
  }
  auto joined = JoinFarm(token, "");
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!joined && std::chrono::steady_clock::now() < deadline) {
    EXPECT_THAT(joined.error().message, HasSubstr("cannot write its data"));
    std::this_thread::sleep_for(milliseconds(100));
    joined = JoinFarm(token, "");
  }
  ASSERT_TRUE(joined) << joined.error().message;
  EXPECT_TRUE(IsAnswered(*joined));
  EXPECT_EQ(MembersListed(), 1u);
  EXPECT_FALSE(JoinFarm(token, "")) << "one use is one use";
  Restart();
  EXPECT_TRUE(IsAnswered(*joined));
  EXPECT_EQ(MembersListed(), 1u);
  EXPECT_FALSE(JoinFarm(token, ""));
}

TEST_F(JoinFailures, NoTokenIsIssuedOnAFullDisk) {
  const NoFileGrows full;
  for (int attempt = 0; attempt < 2; ++attempt) {
    proto::TokenRequest request;
    request.set_key(WriteDigest(Sha256(std::to_string(attempt))));
    request.set_role(WriteRole(Role::kUser));
    request.set_lifetime_s(60);
    request.set_uses(1);
    proto::TokenAnswer answer;
    const grpc::Status status = Call(*access, &proto::Access::Stub::IssueToken, request, answer);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
    EXPECT_TRUE(answer.authority().empty());
  }
}

TEST_F(JoinFailures, ALostIdentityIsNamedAndNotReplacedWhileThereAreMembers) {
  const JoinedFarm ada = Join(Role::kUser, "ada");
  coordinator.reset();
  fs::rename(Identity(), folder / "away");
  const auto refused = Open();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, AllOf(HasSubstr("the key of the farm's authority is missing"),
                                             HasSubstr("put the folder back"), HasSubstr("--start-afresh")));
  EXPECT_FALSE(fs::exists(Identity() / "authority.pem"));
  fs::remove_all(Identity());
  fs::rename(folder / "away", Identity());
  Restart();
  EXPECT_TRUE(IsAnswered(ada));
}

TEST_F(JoinFailures, TheIdentityOfAnotherFarmIsNamedAndLeftAsItIs) {
  const JoinedFarm ada = Join(Role::kUser, "ada");
  current_dir = "other";
  Restart();
  const JoinedFarm bob = Join(Role::kUser, "bob");
  coordinator.reset();
  const fs::path others = Identity();
  current_dir = "data";
  fs::rename(Identity(), folder / "away");
  fs::copy(others, Identity(), fs::copy_options::recursive);
  for (const fs::path& each : {Identity(), others}) fs::permissions(each, fs::perms::owner_all);
  const auto refused = Open();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, AllOf(HasSubstr("holds the authority of another farm"),
                                             HasSubstr("put the folder back"), HasSubstr("--start-afresh")));
  fs::remove_all(Identity());
  fs::rename(folder / "away", Identity());
  Restart();
  EXPECT_TRUE(IsAnswered(ada));
  EXPECT_FALSE(IsAnswered(bob));
}

TEST_F(JoinFailures, AFarmThatStartsAfreshHasAnotherAuthorityFromThenOn) {
  const JoinedFarm ada = Join(Role::kUser, "ada");
  coordinator.reset();
  fs::remove_all(Identity());
  ASSERT_TRUE(Open(true));
  Restart();  // the new authority is that of the farm now
  EXPECT_FALSE(IsAnswered(ada));
  EXPECT_TRUE(IsAnswered(Join(Role::kUser, "ada")));
}

TEST_F(JoinFailures, WithoutMembersALostIdentityIsMadeAgain) {
  coordinator.reset();
  fs::remove_all(Identity());
  Restart();
  EXPECT_TRUE(IsAnswered(Join(Role::kUser, "ada")));
}

}  // namespace
}  // namespace tessera
