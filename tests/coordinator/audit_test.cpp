// Every call that changes something has one entry in the log: who, what, from where, and what came of it.
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <mutex>

#include "tests/coordinator/generic_call.h"
#include "tests/coordinator/members_fixture.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

// Keeps the lines that the coordinator logs.
class LinesSink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::vector<std::string> Take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(lines_, {});
  }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    lines_.emplace_back(message.payload.data(), message.payload.size());
  }
  void flush_() override {}

 private:
  std::vector<std::string> lines_;
};

// Is there before the threads of the coordinator and after them.
class LogKeeper {
 protected:
  LogKeeper() { spdlog::default_logger()->sinks().push_back(sink_); }
  ~LogKeeper() { spdlog::default_logger()->sinks().pop_back(); }
  const std::shared_ptr<LinesSink> sink_ = std::make_shared<LinesSink>();
};

class AuditLog : private LogKeeper, public ServicesForMembers {
 protected:
  // The entries of the calls since the last time.
  std::vector<std::string> Entries() {
    std::vector<std::string> entries;
    for (std::string& line : sink_->Take()) {
      if (line.starts_with("audit ") || line.starts_with("call_denied ")) entries.push_back(std::move(line));
    }
    return entries;
  }
  // The one entry of a call.
  std::string EntryOf(const std::function<void()>& call) {
    Entries();
    call();
    const std::vector<std::string> entries = Entries();
    EXPECT_THAT(entries, SizeIs(1));
    return entries.empty() ? "" : entries[0];
  }
  void Control(grpc::Status (proto::Jobs::Stub::*method)(grpc::ClientContext*, const proto::JobRequest&,
                                                         proto::JobStatus*),
               uint64_t job) {
    proto::JobRequest request;
    request.set_job(job);
    proto::JobStatus status;
    Call(*jobs, method, request, status);
  }
};

TEST_F(AuditLog, AnEntryNamesWhoDidWhatFromWhereToWhatEnd) {
  const JoinedFarm ada = Join(Role::kUser, "ada");
  CallAs(ada);
  const uint64_t job = Submit();
  const std::string entry = EntryOf([&] { Control(&proto::Jobs::Stub::Pause, job); });
  EXPECT_THAT(entry, HasSubstr("audit call=Jobs.Pause by=\"user \\\"ada\\\"\" member="));
  EXPECT_THAT(entry, HasSubstr(fmt::format("member={:016x} peer=", Number(ada.member))));
  EXPECT_THAT(entry, HasSubstr("127.0.0.1"));
  EXPECT_THAT(entry, HasSubstr(fmt::format(" job={} result=done", job)));
  EXPECT_THAT(EntryOf([&] { Control(&proto::Jobs::Stub::Pause, 99); }),
              HasSubstr(" job=99 result=failed reason=\"there is no job 99\""));
}

// Of all services, with requests that fail for want of contents.
TEST_F(AuditLog, EveryCallThatChangesSomethingHasExactlyOneEntryAndNoOtherHasAny) {
  for (const auto* method : AllMethods()) {
    const std::string name = NameOf(*method);
    const auto rule = std::ranges::find(kCallRules, name, &CallRule::method);
    ASSERT_NE(rule, std::end(kCallRules));
    Entries();
    const grpc::Status status = MakeCall(*channel, *method, {""});
    const bool is_denied = status.error_code() == grpc::StatusCode::PERMISSION_DENIED;
    const std::vector<std::string> entries = Entries();
    if (is_denied) {
      EXPECT_THAT(entries, ElementsAre(HasSubstr("call_denied count=1 call=" + name + " ")));
    } else if (rule->effect == Effect::kChanges) {
      EXPECT_THAT(entries, ElementsAre(HasSubstr("audit call=" + name + " "))) << status.error_message();
    } else {
      EXPECT_THAT(entries, IsEmpty()) << name;
    }
  }
}

TEST_F(AuditLog, EveryUploadedFileIsEntered) {
  CallAs(Join(Role::kUser, "ada"));
  const std::string file = "file=" + Sha256("x").Hex() + " bytes=1 result=";
  EXPECT_THAT(EntryOf([&] { EXPECT_TRUE(Upload("x", Sha256("x"), 1).ok()); }), HasSubstr(file + "done"));
  EXPECT_THAT(EntryOf([&] { EXPECT_FALSE(Upload("y", Sha256("z"), 1).ok()); }), HasSubstr("result=failed"));
}

TEST_F(AuditLog, JoiningIsEnteredWithItsToken) {
  const JoinToken token = IssueToken(Role::kUser, "ada");
  const std::string entry = EntryOf([&] { ASSERT_TRUE(JoinFarm(token, "")); });
  EXPECT_THAT(entry, HasSubstr("audit call=Access.Join by=\"the holder of a token\" token="));
  EXPECT_THAT(entry, HasSubstr(" joined="));
  EXPECT_THAT(entry, HasSubstr("role=user name=\"ada\" result=done"));
}

TEST_F(AuditLog, DenialsAreEnteredOneByOneUpToALimit) {
  const uint64_t job = Submit();
  CallAs(Join(Role::kUser, "eve"));
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(EntryOf([&] { Control(&proto::Jobs::Stub::Cancel, job); }),
                HasSubstr("call_denied count=1 call=Jobs.Cancel by=\"user \\\"eve\\\"\""));
  }
  const auto begun = std::chrono::steady_clock::now();
  for (int i = 0; i < 300; ++i) Control(&proto::Jobs::Stub::Cancel, job);
  const auto intervals = (std::chrono::steady_clock::now() - begun) / std::chrono::seconds(10) + 2;
  EXPECT_LE(Entries().size(), static_cast<size_t>(100 * intervals));
}

TEST_F(AuditLog, FailuresAreEnteredOneByOneUpToALimit) {
  CallAs(Join(Role::kUser, "eve"));
  Entries();
  const auto begun = std::chrono::steady_clock::now();
  for (int i = 0; i < 300; ++i) {
    EXPECT_FALSE(Upload("y", Sha256("z"), 1).ok());
    Control(&proto::Jobs::Stub::Pause, 99);
  }
  const auto intervals = (std::chrono::steady_clock::now() - begun) / std::chrono::seconds(10) + 2;
  const size_t entries = Entries().size();
  EXPECT_GE(entries, 200u) << "uploads and other calls are counted apart";
  EXPECT_LE(entries, static_cast<size_t>(200 * intervals));
  const uint64_t job = Submit();
  EXPECT_THAT(EntryOf([&] { Control(&proto::Jobs::Stub::Pause, job); }), HasSubstr("result=done"))
      << "what has changed something always has an entry";
}

TEST_F(AuditLog, NamesForgeNoEntries) {
  const std::string forged = "x\" by=\"operator\naudit call=Access.Revoke by=root\x1b[2J\xe2\x80\xae";
  CallAs(Join(Role::kUser, forged));
  proto::JobSpec spec = PrepareJob();
  spec.set_name(forged);
  const std::string entry = EntryOf([&] {
    proto::SubmitAnswer answer;
    EXPECT_TRUE(Call(*jobs, &proto::Jobs::Stub::Submit, spec, answer).ok());
  });
  EXPECT_THAT(entry, testing::StartsWith("audit call=Jobs.Submit by=\"user "));
  EXPECT_THAT(entry, Not(HasSubstr("\n")));
  EXPECT_THAT(entry, Not(HasSubstr("\x1b")));
  EXPECT_THAT(entry, Not(HasSubstr("\xe2\x80\xae")));
  EXPECT_THAT(entry, Not(HasSubstr("x\" by=\"operator"))) << "quotes are escaped";
}

}  // namespace
}  // namespace tessera
