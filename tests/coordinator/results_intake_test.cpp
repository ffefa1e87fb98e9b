#include "coordinator/results_intake.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <list>

#include "tests/coordinator/services_fixture.h"

namespace tessera {
namespace {

using grpc::StatusCode;
using testing::ElementsAre;
using testing::HasSubstr;

struct Line {
  // A call of a sender of its own.
  void Enter(int call, uint64_t bytes) { Enter(call, bytes, std::to_string(call)); }
  void Enter(int call, uint64_t bytes, const std::string& sender) {
    intake.Enter({Id(call), sender, bytes, [this, call] { admitted.push_back(call); },
                  [this, call] {
                    expired.push_back(call);
                    intake.Leave(Id(call));
                  }});
  }
  static CallId Id(int call) { return CallId{static_cast<uint64_t>(call)}; }
  void Leave(int call) { intake.Leave(Id(call)); }
  void ExpireAfter(std::chrono::seconds duration) { intake.Expire(ResultsIntake::Clock::now() + duration); }
  // One is in, a large one waits, and a small one behind it.
  void EnterWithALargeOneWaiting() {
    Enter(1, 60);
    Enter(2, 90);
    Enter(3, 1);
  }
  ResultsIntake intake{100};
  std::vector<int> admitted, expired;
};

TEST(ResultsIntake, AdmitsCallsUntilTheRoomIsUsedAndTheNextWhenOneLeaves) {
  Line line;
  line.Enter(1, 60);
  line.Enter(2, 40);
  line.Enter(3, 30);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2));
  line.Leave(2);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2, 3));
  EXPECT_EQ(line.intake.bytes(), 90u);
}

TEST(ResultsIntake, CallsAreAdmittedInOrder) {
  Line line;
  line.EnterWithALargeOneWaiting();
  EXPECT_THAT(line.admitted, ElementsAre(1));
  line.Leave(1);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2, 3));
}

TEST(ResultsIntake, ACallLargerThanTheWholeRoomIsAdmittedAlone) {
  Line line;
  line.Enter(1, 1);
  line.Enter(2, 1000);
  EXPECT_THAT(line.admitted, ElementsAre(1));
  line.Leave(1);
  line.Enter(3, 1);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2));
  line.Leave(2);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2, 3));
}

TEST(ResultsIntake, AWithdrawnCallMakesWayForThoseAfterIt) {
  Line line;
  line.EnterWithALargeOneWaiting();
  EXPECT_FALSE(line.intake.Withdraw(CallId{1})) << "it is in already";
  EXPECT_TRUE(line.intake.Withdraw(CallId{2}));
  EXPECT_FALSE(line.intake.Withdraw(CallId{2}));
  EXPECT_THAT(line.admitted, ElementsAre(1, 3));
  EXPECT_EQ(line.intake.waiting(), 0u);
}

TEST(ResultsIntake, SendersWithoutRoomComeBeforeOtherCallsOfOneSender) {
  Line line;
  line.Enter(1, 90, "greedy");
  line.Enter(2, 90, "greedy");
  line.Enter(3, 90, "greedy");
  line.Enter(4, 90, "other");
  line.Leave(1);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2)) << "it had nothing in the room then";
  line.Enter(5, 5, "other");
  EXPECT_THAT(line.admitted, ElementsAre(1, 2)) << "4 waits for room, and no one overtakes it";
  line.Leave(2);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2, 3));
  line.Leave(3);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2, 3, 4, 5));
}

TEST(ResultsIntake, ResultsThatDoNotArriveLoseTheirRoomOnlyIfOthersWait) {
  Line line;
  line.Enter(1, 60);
  line.Enter(2, 40);
  line.intake.Arrived(Line::Id(2));
  line.ExpireAfter(2 * kArrivalPatience);
  EXPECT_THAT(line.expired, ElementsAre());
  line.Enter(3, 50);
  line.ExpireAfter(kArrivalPatience / 2);
  EXPECT_THAT(line.expired, ElementsAre());
  line.ExpireAfter(2 * kArrivalPatience);
  EXPECT_THAT(line.expired, ElementsAre(1)) << "2 has arrived, the disk is what is slow";
  EXPECT_THAT(line.admitted, ElementsAre(1, 2, 3));
}

TEST(ResultsIntake, SeveralAnnouncementsOfOneSenderLoseTheirRoomSoon) {
  Line line;
  line.Enter(1, 50, "greedy");
  line.Enter(2, 50, "greedy");
  line.Enter(3, 50);
  line.ExpireAfter(2 * kSecondArrivalPatience);
  EXPECT_THAT(line.expired, ElementsAre(1, 2));
  EXPECT_THAT(line.admitted, ElementsAre(1, 2, 3));
}

TEST(ResultsIntake, SendersThatKeptRoomForNothingComeLast) {
  Line line;
  line.Enter(1, 90, "lapsed");
  line.Enter(2, 90);
  line.ExpireAfter(2 * kArrivalPatience);
  line.Enter(3, 90, "lapsed");
  line.Enter(4, 90);
  line.Leave(2);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2, 4));
  line.Leave(4);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2, 4, 3));
  line.intake.Arrived(Line::Id(3));
  line.Enter(5, 90, "lapsed");
  line.Enter(6, 90);
  line.Leave(3);
  EXPECT_THAT(line.admitted, ElementsAre(1, 2, 4, 3, 5)) << "it sends what it announces again";
}

// Whether the condition becomes true within kPatience.
bool Comes(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!condition() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(milliseconds(1));
  return condition();
}

// A worker that announces results and then hangs.
class HangingReturn {
 public:
  HangingReturn(proto::Work::Stub& work, int64_t bytes, uint64_t worker)
      : writer_(work.ReturnResults(&context_, &answer_)) {
    proto::ResultsRequest announcement;
    announcement.set_worker(worker);
    announcement.set_bytes(static_cast<uint64_t>(bytes));
    writer_->Write(announcement);
  }
  ~HangingReturn() { CutOff(); }
  void CutOff() {
    context_.TryCancel();
    if (std::exchange(open_, false)) writer_->Finish();
  }

 private:
  grpc::ClientContext context_;
  proto::ResultsAnswer answer_;
  std::unique_ptr<grpc::ClientWriter<proto::ResultsRequest>> writer_;
  bool open_ = true;
};

TEST_F(Services, ResultsWaitUntilThereIsRoomForThem) {
  const uint64_t job = Submit();
  const ResultsIntake& intake = coordinator->intake();
  std::list<HangingReturn> admitted, in_line;
  while ((admitted.size() + 1) * kMessageBytesMax <= kIntakeBytesMax)
    admitted.emplace_back(*work, kMessageBytesMax, 100 + admitted.size());
  ASSERT_TRUE(Comes([&] { return intake.bytes() == admitted.size() * kMessageBytesMax; }));
  in_line.emplace_back(*work, kMessageBytesMax, 200);
  in_line.emplace_back(*work, kMessageBytesMax, 201);
  ASSERT_TRUE(Comes([&] { return intake.waiting() == 2; }));

  proto::ResultsAnswer answer;
  auto returning = std::async(std::launch::async, [&] { return Return(job, 0, {0, 4}, answer); });
  ASSERT_TRUE(Comes([&] { return intake.waiting() == 3; }));
  in_line.back().CutOff();
  ASSERT_TRUE(Comes([&] { return intake.waiting() == 2; })) << "a cancelled call leaves the queue";
  admitted.front().CutOff();
  ASSERT_TRUE(returning.get().ok()) << "a cancelled call gives its room to those that wait";
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::ACCEPTED);
}

TEST_F(Services, AnnouncementsWithoutResultsDelayOthersOnlyBriefly) {
  const uint64_t job = Submit();
  std::list<HangingReturn> hanging;
  for (int i = 0; i < 60; ++i) hanging.emplace_back(*work, kMessageBytesMax, 8);
  ASSERT_TRUE(Comes([&] { return coordinator->intake().waiting() > 0; }));
  proto::ResultsAnswer answer;
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(Return(job, 0, {0, 4}, answer).ok());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::ACCEPTED);
}

TEST_F(Services, TilesAreRefusedUnlessTheyAreThoseOfTheirUnit) {
  const uint64_t job = Submit();
  RadianceTile huge{{0, 0, kTileSizeMax, kTileSizeMax}, {0, 4}, {60}, {}};
  huge.sums.resize(static_cast<size_t>(huge.bounds.area()) * huge.shape.stride());
  proto::ResultsAnswer answer;
  ASSERT_TRUE(Return(ResultOf(job, 0, {0, 4}, EncodeRadianceTile(huge)), answer).ok());
  EXPECT_EQ(answer.verdicts(0), proto::ResultsAnswer::REFUSED);
  EXPECT_THAT(answer.reasons(0), HasSubstr("does not have the bounds of its tile"));
  // One that takes more memory than there is room for.
  proto::ResultsRequest results = ResultOf(job, 0, {0, 4}, EncodeRadianceTile(huge));
  for (int i = 0; i < 8; ++i) *results.add_results() = results.results(0);
  EXPECT_EQ(Return(results, answer).error_code(), StatusCode::RESOURCE_EXHAUSTED);
}

TEST_F(Services, ResultsThatDifferFromTheirAnnouncementAreRefused) {
  const uint64_t job = Submit();
  const proto::ResultsRequest results = ResultOf(job, 0, {0, 4}, "not a tile");
  proto::WorkerDirective directive;
  ASSERT_TRUE(Synchronize(Worker(milliseconds(0)), directive).ok());
  const auto refusal = [&](uint64_t worker, uint64_t bytes) {
    proto::ResultsRequest announcement;
    announcement.set_worker(worker);
    announcement.set_bytes(bytes);
    proto::ResultsAnswer answer;
    return Return(announcement, results, answer);
  };
  EXPECT_THAT(refusal(0, 100).error_message(), HasSubstr("worker is missing"));
  EXPECT_THAT(refusal(7, 0).error_message(), HasSubstr("bytes is missing"));
  EXPECT_THAT(refusal(7, 3).error_message(), HasSubstr("larger than announced"));
  EXPECT_EQ(refusal(7, 3).error_code(), StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(refusal(7, kMessageBytesMax + 1).error_code(), StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(refusal(7, 100).ok());
  EXPECT_TRUE(Comes([&] { return coordinator->intake().bytes() == 0; }));
}

}  // namespace
}  // namespace tessera
