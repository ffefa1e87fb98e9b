// Every kind of fact survives its bytes: one that is written and cannot be read would stop the coordinator at
// its next start. A kind without an example here does not compile.
#include <gtest/gtest.h>

#include <type_traits>
#include <utility>

#include "coordinator/core/fact.h"

namespace tessera {
namespace {

template <typename Kind>
using Example = std::type_identity<Kind>;

std::shared_ptr<const JobSpec> SomeSpec() {
  JobSpec spec;
  spec.name = "job";
  FrameSpec frame;
  frame.width = frame.height = 16;
  frame.crop = {0, 0, 16, 16};
  frame.samples_per_pixel = 4;
  spec.frames = {{"scene.pbrt", "", frame, 0}};
  return std::make_shared<const JobSpec>(std::move(spec));
}

std::shared_ptr<const JobOrder> SomeOrder() {
  return std::make_shared<const JobOrder>(
      JobOrder{9, "job", 0, {Sha256("p"), "scene.pbrt", "", FrameRange{1, 9, 2}, 25}});
}

CoordinatorStarted Make(Example<CoordinatorStarted>) {
  return {7, {5, 6}};
}
JobSubmitted Make(Example<JobSubmitted>) {
  return {JobId{3}, SomeSpec()};
}
JobOrdered Make(Example<JobOrdered>) {
  return {JobId{3}, SomeOrder()};
}
JobOwned Make(Example<JobOwned>) {
  return {JobId{3}, {MemberId{4}, "ada"}};
}
JobTimed Make(Example<JobTimed>) {
  return {JobId{3}, 1'700'000'000'000, 1'700'000'060'000, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}};
}
FrameFinished Make(Example<FrameFinished>) {
  return {JobId{3}, 1, {Sha256("f"), 7}, 64};
}
FrameFailed Make(Example<FrameFailed>) {
  return {JobId{3}, 1, "why"};
}
JobEnded Make(Example<JobEnded>) {
  return {JobId{3}, JobState::kFailed, "why"};
}
JobExtended Make(Example<JobExtended>) {
  return {JobId{3}, 8};
}
FrameResumed Make(Example<FrameResumed>) {
  return {JobId{3}, 1};
}
JobsForgotten Make(Example<JobsForgotten>) {
  return {JobId{3}};
}
JobPaused Make(Example<JobPaused>) {
  return {JobId{3}, true};
}
JobPriorityChanged Make(Example<JobPriorityChanged>) {
  return {JobId{3}, -5};
}
WorkerQuarantined Make(Example<WorkerQuarantined>) {
  return {WorkerId{7}, "blade", true, "why"};
}
VoteRecorded Make(Example<VoteRecorded>) {
  return {{JobId{3}, 1, 2, {4, 4}}, WorkerId{7}, "blade", Sha256("r"), 99};
}
UnitsCounted Make(Example<UnitsCounted>) {
  return {JobId{3}, 1, 2, 3};
}
TokenIssued Make(Example<TokenIssued>) {
  return {{Sha256("k"), Role::kUser, "ada", 100, 200, 2}};
}
TokenRevoked Make(Example<TokenRevoked>) {
  return {Sha256("k")};
}
MemberJoined Make(Example<MemberJoined>) {
  return {{MemberId{4}, Role::kUser, "ada", 100, 200, Sha256("k")}};
}
MemberRenewed Make(Example<MemberRenewed>) {
  return {MemberId{4}, 300};
}
MemberRevoked Make(Example<MemberRevoked>) {
  return {MemberId{4}};
}
AuthorityChosen Make(Example<AuthorityChosen>) {
  return {Sha256("a")};
}

template <size_t kIndex>
void ExpectThatItSurvivesItsBytes() {
  const Fact fact = Make(Example<std::variant_alternative_t<kIndex, Fact>>());
  const std::string bytes = EncodeFact(fact);
  const auto read = DecodeFact(bytes);
  ASSERT_TRUE(read) << "alternative " << kIndex << ": " << read.error().message;
  EXPECT_EQ(read->index(), kIndex);
  EXPECT_EQ(EncodeFact(*read), bytes) << "alternative " << kIndex;
}

TEST(FactKinds, EachSurvivesItsBytes) {
  [&]<size_t... kIndices>(std::index_sequence<kIndices...>) {
    (ExpectThatItSurvivesItsBytes<kIndices>(), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Fact>>());
}

}  // namespace
}  // namespace tessera
