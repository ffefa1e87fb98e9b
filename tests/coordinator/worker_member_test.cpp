// A worker is who its certificate says, and reads no more than what it renders.
#include "coordinator/open_jobs.h"
#include "tests/coordinator/members_fixture.h"

namespace tessera {
namespace {

using grpc::StatusCode;
using testing::HasSubstr;

class WorkerMembers : public ServicesForMembers {
 protected:
  grpc::Status Join(const std::string& announced_name) {
    WorkerState state = Worker(milliseconds(0));
    state.name = announced_name;
    proto::WorkerDirective directive;
    return Synchronize(state, directive);
  }
  grpc::Status FailUnit() {
    proto::FailureRequest request;
    request.set_worker(7);
    request.set_scene(WriteDigest(scene_key));
    request.set_farm(WriteFarmId(farm));
    proto::FailureAnswer answer;
    return Call(*work, &proto::Work::Stub::ReturnFailure, request, answer);
  }
  grpc::Status Download(const std::string& package, const Digest& digest, bool suspect = false) {
    grpc::ClientContext context;
    SetDeadline(context, kPatience);
    proto::DownloadRequest request;
    request.set_digest(WriteDigest(digest));
    request.set_package(package);
    request.set_suspect(suspect);
    const auto reader = blobs->Download(&context, request);
    proto::DownloadChunk chunk;
    while (reader->Read(&chunk)) {
    }
    return reader->Finish();
  }
  void ExpectDenied(const grpc::Status& status, const std::string& message) {
    EXPECT_EQ(status.error_code(), StatusCode::PERMISSION_DENIED) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr(message));
  }
  const JoinedFarm blade = ServicesForMembers::Join(Role::kWorker, "blade");
  const JoinedFarm other = ServicesForMembers::Join(Role::kWorker, "other");
};

TEST_F(WorkerMembers, AWorkerHasTheNameOfItsCertificate) {
  CallAs(blade);
  ASSERT_TRUE(Join("impostor").ok());
  CallAsLocalUser();
  proto::WorkersAnswer answer;
  ASSERT_TRUE(Call(*jobs, &proto::Jobs::Stub::Workers, proto::WorkersRequest(), answer).ok());
  ASSERT_EQ(answer.workers_size(), 1);
  EXPECT_EQ(answer.workers(0).name(), "blade");
}

TEST_F(WorkerMembers, AWorkerCannotSpeakForAnother) {
  const uint64_t job = Submit();
  CallAs(blade);
  ASSERT_TRUE(Join("blade").ok());
  CallAs(other);
  ExpectDenied(Join("blade"), "for worker 0000000000000007, which is not its own");
  ExpectDenied(FailUnit(), "may not call Work.ReturnFailure");
  const proto::ResultsRequest results = ResultOf(job, 0, {0, 4}, "x");
  proto::ResultsAnswer answer;
  ExpectDenied(Return(Announcement(WorkerId{7}, farm, results), results, answer),
               "may not call Work.ReturnResults");
  CallAs(blade);
  EXPECT_TRUE(Join("blade").ok());
  EXPECT_TRUE(FailUnit().ok());
}

TEST_F(WorkerMembers, AWorkerOfTheLocalUserIsNoMembersOwn) {
  ASSERT_TRUE(Join("local").ok());
  CallAs(blade);
  ExpectDenied(Join("blade"), "which is not its own");
}

TEST_F(WorkerMembers, AWorkerFetchesFilesOfOpenJobsOnly) {
  const std::string secret = "uploaded, and part of no job";
  ASSERT_TRUE(Upload(secret, Sha256(secret), secret.size()).ok());
  const proto::JobSpec job = PrepareJob();
  CallAs(blade);
  ExpectDenied(Download(job.package(), Sha256("a scene")), "is not in the scene package");
  CallAsLocalUser();
  Submit();
  EXPECT_TRUE(Download("", Sha256(secret)).ok()) << "the local user may do everything";
  CallAs(blade);
  EXPECT_TRUE(Download(job.package(), Sha256("a scene")).ok());
  EXPECT_TRUE(Download(job.package(), *ReadDigest(job.package(), "package")).ok());
  for (const bool suspect : {false, true})
    ExpectDenied(Download(job.package(), Sha256(secret), suspect), "is not in the scene package");
  ExpectDenied(Download(WriteDigest(Sha256("no package")), Sha256("a scene")), "of an open job");
  ExpectDenied(Download(WriteDigest(Sha256(secret)), Sha256(secret)), "of an open job");
  EXPECT_EQ(Download("", Sha256("a scene")).error_code(), StatusCode::INVALID_ARGUMENT);
}

TEST(OpenJobs, AScenePackageIsOpenWithItsLastJobAndAMomentLonger) {
  const auto job_of = [](const Digest& package) {
    auto spec = std::make_shared<JobSpec>();
    spec->package = package;
    return spec;
  };
  const OpenJobs::Clock::time_point now = OpenJobs::Clock::now();
  const Digest shared = Sha256("shared"), other = Sha256("other");
  OpenJobs jobs;
  EXPECT_FALSE(jobs.HasPackage(shared, now));
  jobs.Set(JobId{1}, job_of(shared));
  jobs.Set(JobId{1}, job_of(shared));  // as when it is extended
  jobs.Set(JobId{2}, job_of(shared));
  jobs.Set(JobId{3}, job_of(other));
  jobs.Remove(JobId{1}, now);
  EXPECT_TRUE(jobs.HasPackage(shared, now + 2 * kPackageGrace));
  jobs.Remove(JobId{2}, now);
  jobs.Remove(JobId{2}, now);
  EXPECT_TRUE(jobs.HasPackage(shared, now + kPackageGrace / 2));
  EXPECT_FALSE(jobs.HasPackage(shared, now + kPackageGrace));
  jobs.Remove(JobId{3}, now + 2 * kPackageGrace);
  jobs.Set(JobId{4}, job_of(shared));
  EXPECT_TRUE(jobs.HasPackage(shared, now + 3 * kPackageGrace));
}

}  // namespace
}  // namespace tessera
