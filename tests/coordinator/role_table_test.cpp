// Every call, made by everybody who can connect, for what is theirs and for what is not, over real TLS
// connections. The calls are those of the .proto files; the table below says who may make them.
#include <google/protobuf/descriptor.h>
#include <google/protobuf/dynamic_message.h>
#include <grpcpp/security/credentials.h>

#include <set>

#include "coordinator/store/file_journal.h"
#include "proto/access.pb.h"
#include "proto/identity/private_file.h"
#include "proto/identity/subject.h"
#include "tests/coordinator/generic_call.h"
#include "tests/coordinator/members_fixture.h"

namespace tessera {
namespace {

using google::protobuf::MethodDescriptor;
using grpc::StatusCode;
using testing::AnyOf;
using testing::HasSubstr;

enum May { kNo, kOwn, kAll };

struct Row {
  const char* method;
  May worker, user, viewer, op, token;
};

constexpr Row kTable[] = {
    {"Blobs.FindMissing", kNo, kAll, kNo, kAll, kNo},
    {"Blobs.Upload", kNo, kAll, kNo, kAll, kNo},
    {"Blobs.Download", kOwn, kNo, kNo, kAll, kNo},
    {"Jobs.Submit", kNo, kAll, kNo, kAll, kNo},
    {"Jobs.List", kNo, kAll, kAll, kAll, kNo},
    {"Jobs.Status", kNo, kAll, kAll, kAll, kNo},
    {"Jobs.Watch", kNo, kAll, kAll, kAll, kNo},
    {"Jobs.Cancel", kNo, kOwn, kNo, kAll, kNo},
    {"Jobs.Extend", kNo, kOwn, kNo, kAll, kNo},
    {"Jobs.Pause", kNo, kOwn, kNo, kAll, kNo},
    {"Jobs.Resume", kNo, kOwn, kNo, kAll, kNo},
    {"Jobs.SetPriority", kNo, kOwn, kNo, kAll, kNo},
    {"Jobs.Workers", kNo, kAll, kAll, kAll, kNo},
    {"Jobs.Frames", kNo, kAll, kAll, kAll, kNo},
    {"Jobs.DrainWorkers", kNo, kNo, kNo, kAll, kNo},
    {"Jobs.ReleaseWorkers", kNo, kNo, kNo, kAll, kNo},
    {"Jobs.FetchPicture", kNo, kOwn, kAll, kAll, kNo},
    {"Jobs.Health", kAll, kAll, kAll, kAll, kNo},
    {"Jobs.JobLog", kNo, kAll, kAll, kAll, kNo},
    {"Work.Synchronize", kOwn, kNo, kNo, kAll, kNo},
    {"Work.ReturnResults", kOwn, kNo, kNo, kAll, kNo},
    {"Work.ReturnFailure", kOwn, kNo, kNo, kAll, kNo},
    {"Work.ReturnPreparation", kOwn, kNo, kNo, kAll, kNo},
    {"Access.Join", kNo, kNo, kNo, kNo, kAll},
    {"Access.Renew", kAll, kAll, kAll, kAll, kNo},
    {"Access.IssueToken", kNo, kNo, kNo, kAll, kNo},
    {"Access.ListAccess", kNo, kNo, kNo, kAll, kNo},
    {"Access.Revoke", kNo, kNo, kNo, kAll, kNo},
};

const Row* RowOf(const std::string& method) {
  for (const Row& row : kTable) {
    if (row.method == method) return &row;
  }
  return nullptr;
}

class RoleTable : public ServicesForMembers {
 protected:
  RoleTable() {
    // What is the user's and the worker's own, and what is others'.
    CallAs(user);
    job = SubmitAs(1);
    CallAs(Join(Role::kUser, "bob"));
    others_job = SubmitAs(2);
    CallAs(worker);
    JoinWorker(WorkerId{7});
    CallAs(Join(Role::kWorker, "rack"));
    JoinWorker(WorkerId{8});
  }
  uint64_t SubmitAs(uint64_t submission) {
    proto::JobSpec spec = PrepareJob();
    spec.set_submission(submission);
    package = spec.package();
    proto::SubmitAnswer answer;
    const grpc::Status status = Call(*jobs, &proto::Jobs::Stub::Submit, spec, answer);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return answer.job();
  }
  WorkerState StateOf(WorkerId id) {
    WorkerState state = Worker(milliseconds(0));
    state.worker = id;
    return state;
  }
  void JoinWorker(WorkerId id) {
    proto::WorkerDirective directive;
    const grpc::Status status = Synchronize(StateOf(id), directive);
    EXPECT_TRUE(status.ok()) << status.error_message();
  }
  // The messages of a call about what is the caller's own, or others'. Whoever may make the call gets past
  // the check of its role; the rest is as short as possible.
  std::vector<std::string> MessagesOf(const MethodDescriptor& method, bool is_own) {
    const WorkerId process{is_own ? 7u : 8u};
    const std::string name = NameOf(method);
    if (name == "Work.Synchronize") {
      proto::WorkerState state;
      Write(StateOf(process), state);
      return {state.SerializeAsString()};
    }
    if (name == "Work.ReturnResults") {
      const proto::ResultsRequest results = ResultOf(job, 0, {0, 4}, "x");
      return {Announcement(process, farm, results).SerializeAsString(), results.SerializeAsString()};
    }
    if (name == "Work.ReturnPreparation") {
      proto::PreparationReport report;
      report.set_worker(Number(process));
      report.set_farm(WriteFarmId(farm));
      report.set_key(WriteDigest(Sha256("an order")));
      report.set_reason("no");
      return {report.SerializeAsString()};
    }
    if (name == "Blobs.Download") {
      proto::DownloadRequest request;
      request.set_package(package);
      request.set_digest(WriteDigest(Sha256(is_own ? "a scene" : "what is in no package")));
      return {request.SerializeAsString()};
    }
    google::protobuf::DynamicMessageFactory factory;
    const std::unique_ptr<google::protobuf::Message> message(
        factory.GetPrototype(method.input_type())->New());
    const auto set = [&](const char* field, auto value, auto setter) {
      const auto* found = method.input_type()->FindFieldByName(field);
      if (found != nullptr) (message->GetReflection()->*setter)(message.get(), found, value);
    };
    using google::protobuf::Reflection;
    set("job", is_own ? job : others_job, &Reflection::SetUInt64);
    set("worker", Number(process), &Reflection::SetUInt64);
    set("scene", WriteDigest(scene_key),
        static_cast<void (Reflection::*)(google::protobuf::Message*, const google::protobuf::FieldDescriptor*,
                                         std::string) const>(&Reflection::SetString));
    set("farm", WriteFarmId(farm),
        static_cast<void (Reflection::*)(google::protobuf::Message*, const google::protobuf::FieldDescriptor*,
                                         std::string) const>(&Reflection::SetString));
    set("samples_per_pixel", 4u, &Reflection::SetUInt32);
    return {message->SerializeAsString()};
  }
  void ExpectTable(const std::string& who, grpc::Channel& connection, May Row::*column) {
    for (const auto* method : AllMethods()) {
      const Row* const row = RowOf(NameOf(*method));
      if (row == nullptr) continue;  // another test complains
      for (const bool is_own : {true, false}) {
        const May may = row->*column;
        const bool is_allowed = may == kAll || (may == kOwn && is_own);
        const grpc::Status status = MakeCall(connection, *method, MessagesOf(*method, is_own));
        const std::string what = who + ", " + row->method + (is_own ? ", own: " : ", others': ") +
                                 std::to_string(status.error_code()) + " " + status.error_message();
        EXPECT_EQ(status.error_code() != StatusCode::PERMISSION_DENIED, is_allowed) << what;
        EXPECT_NE(status.error_code(), StatusCode::UNAUTHENTICATED) << what;
        EXPECT_NE(status.error_code(), StatusCode::UNAVAILABLE) << what;
        EXPECT_NE(status.error_code(), StatusCode::DEADLINE_EXCEEDED) << what;
        if (is_allowed) continue;
        EXPECT_THAT(status.error_message(), AnyOf(HasSubstr("may not"), HasSubstr("is a member"))) << what;
      }
    }
  }
  // Every call over this connection ends with this code and a text of this kind.
  void ExpectRefused(grpc::Channel& connection, StatusCode code, const std::string& text) {
    for (const auto* method : AllMethods()) {
      const grpc::Status status = MakeCall(connection, *method, MessagesOf(*method, true));
      EXPECT_EQ(status.error_code(), code) << NameOf(*method) << ": " << status.error_message();
      EXPECT_THAT(status.error_message(), HasSubstr(text)) << NameOf(*method);
    }
  }
  std::shared_ptr<grpc::Channel> ChannelWith(const PrivateKey& key, const Certificate& certificate) const {
    return OpenChannel(tls_address(),
                       TlsClientCredentials(user.identity.authority_pem, key.Pem(), certificate.Pem()));
  }
  static CertificateTerms TermsOf(const JoinedFarm& member) {
    CertificateTerms terms;
    terms.common_name = member.name;
    terms.uri = Subject{member.role, member.member, {}}.Uri();
    terms.lifetime = std::chrono::hours(24);
    terms.serial = 1;
    return terms;
  }

  const JoinedFarm worker = Join(Role::kWorker, "blade"), user = Join(Role::kUser, "ada"),
                   viewer = Join(Role::kViewer, "vera"), op = Join(Role::kOperator, "root");
  uint64_t job = 0, others_job = 0;
  std::string package;
};

TEST_F(RoleTable, NamesEveryCallOnce) {
  std::multiset<std::string> methods, rows;
  for (const auto* method : AllMethods()) methods.insert(NameOf(*method));
  for (const Row& row : kTable) rows.insert(row.method);
  EXPECT_EQ(rows, methods);
}

TEST_F(RoleTable, AWorkerMayWorkAndReadWhatItRenders) {
  ExpectTable("worker", *ChannelOf(worker), &Row::worker);
}

TEST_F(RoleTable, AUserMaySubmitAndTouchItsOwnJobs) {
  ExpectTable("user", *ChannelOf(user), &Row::user);
}

TEST_F(RoleTable, AViewerMayLook) {
  ExpectTable("viewer", *ChannelOf(viewer), &Row::viewer);
}

TEST_F(RoleTable, AnOperatorMayDoEverything) {
  ExpectTable("operator", *ChannelOf(op), &Row::op);
}

TEST_F(RoleTable, TheLocalUserMayDoEverything) {
  ExpectTable("local", *OpenChannel(coordinator->addresses().front()), &Row::op);
}

TEST_F(RoleTable, TheHolderOfATokenMayJoin) {
  const JoinToken token = IssueToken(Role::kOperator, "");
  ExpectTable("token", *ChannelOf(token, user), &Row::token);
}

TEST_F(RoleTable, WhoeverIsRevokedMayDoNothingAndIsToldWhatToDo) {
  Revoke("ada");
  ExpectRefused(*ChannelOf(user), StatusCode::UNAUTHENTICATED,
                "the certificate of user \"ada\" was revoked; ask an operator of the farm for a token");
}

TEST_F(RoleTable, WhoseCertificateHasExpiredMayDoNothingAndIsToldWhatToDo) {
  coordinator.reset();
  const auto pem = ReadPrivateFile(folder / "data/identity/authority.pem");
  ASSERT_TRUE(pem);
  const auto authority = Authority::FromPem(*pem, "authority");
  ASSERT_TRUE(authority);
  const UnixTime past = UnixNow() - 100 * 24 * 3600;
  {
    const auto journal = FileJournal::Open(folder / "data/journal", [](const Fact&) {});
    ASSERT_TRUE(journal) << journal.error().message;
    (*journal)->Append(MemberRenewed{user.member, past + 24 * 3600});
    ASSERT_TRUE((*journal)->Sync());
  }
  Restart();
  const PrivateKey key = PrivateKey::Generate();
  ExpectRefused(*ChannelWith(key, authority->Issue(key, TermsOf(user), past)), StatusCode::UNAUTHENTICATED,
                "expired on");
}

// They reach nothing but the handshake.
TEST_F(RoleTable, StrangersGetNoAnswerToAnything) {
  const UnixTime now = UnixNow();
  const PrivateKey key = PrivateKey::Generate();
  const Authority other = Authority::Make("another farm", now);
  const JoinToken unknown = JoinToken::Make(tls_address().Text(), *coordinator->authority_fingerprint());
  const std::pair<const char*, std::shared_ptr<grpc::Channel>> strangers[] = {
      {"self-signed", ChannelWith(key, MakeSelfSigned(key, TermsOf(op), now))},
      {"of another authority", ChannelWith(key, other.Issue(key, TermsOf(op), now))},
      {"a token of another farm", ChannelOf(unknown, user)},
      {"plain text", OpenChannel(tls_address(), grpc::InsecureChannelCredentials())},
  };
  for (const auto& [who, connection] : strangers) {
    for (const auto* method : AllMethods()) {
      const grpc::Status status = MakeCall(*connection, *method, MessagesOf(*method, true));
      EXPECT_EQ(status.error_code(), StatusCode::UNAVAILABLE)
          << who << ": " << NameOf(*method) << ": " << status.error_message();
    }
  }
}

}  // namespace
}  // namespace tessera
