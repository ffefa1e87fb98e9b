// Text in messages: names, reasons and notices.
#include <gtest/gtest.h>

#include "proto/jobs.pb.h"
#include "proto/wire/convert.h"
#include "proto/work.pb.h"

#include "tests/proto/wire/frame_examples.h"

namespace tessera {
namespace {

JobSpec Job() {
  JobSpec job;
  job.submission = 5;
  job.package = Sha256("package");
  job.frames = {{"scene.pbrt", "", GoodFrame(), 1}};
  return job;
}

WorkerState Worker() {
  WorkerState worker;
  worker.worker = WorkerId{7};
  worker.slots = 1;
  worker.farm = {1, 2};
  return worker;
}

TEST(ConvertText, ReasonsAreOneLineAndBounded) {
  EXPECT_EQ(CleanReason("a\nb\tc\x1b[31m"), "a b c [31m");
  EXPECT_EQ(CleanReason(std::string(kReasonBytesMax * 2, 'x')).size(), kReasonBytesMax);
}

// Whatever text the values hold, the messages can be sent and read.
TEST(ConvertText, AnyTextCanBeDelivered) {
  std::string accents = "x";
  for (size_t i = 0; i < kReasonBytesMax; ++i) accents += "\xc3\xa9";
  for (const std::string& text : {accents, std::string("caf\xe9\n\xe2\x80\xae"), std::string("\xed\xa0\x80"),
                                  std::string(100'000, '\xff')}) {
    JobStatus job;
    job.name = job.reason = text;
    proto::JobStatus job_message, job_sent;
    Write(job, job_message);
    EXPECT_TRUE(job_sent.ParseFromString(job_message.SerializeAsString()));
    EXPECT_LE(ReadJobStatus(job_sent)->reason.size(), kReasonBytesMax);
    WorkerState worker = Worker();
    worker.name = text;
    proto::WorkerState worker_message, worker_sent;
    Write(worker, worker_message);
    ASSERT_TRUE(worker_sent.ParseFromString(worker_message.SerializeAsString()));
    ASSERT_TRUE(ReadWorkerState(worker_sent));
    EXPECT_LE(ReadWorkerState(worker_sent)->name.size(), kNameBytesMax);
    JobSpec spec = Job();
    spec.name = text;
    proto::JobSpec spec_message, spec_sent;
    Write(spec, spec_message);
    ASSERT_TRUE(spec_sent.ParseFromString(spec_message.SerializeAsString()));
    EXPECT_TRUE(ReadJobSpec(spec_sent));
    WorkerStatus status;
    status.name = status.reason = text;
    proto::WorkerStatus status_message, status_sent;
    Write(status, status_message);
    EXPECT_TRUE(status_sent.ParseFromString(status_message.SerializeAsString()));
    WorkerDirective directive;
    directive.notice = text;
    proto::WorkerDirective directive_message, directive_sent;
    Write(directive, directive_message);
    EXPECT_TRUE(directive_sent.ParseFromString(directive_message.SerializeAsString()));
  }
}

TEST(ConvertText, NamesAreTheSameInBothDirectionsAndSpellings) {
  proto::WorkerState message;
  Write(Worker(), message);
  message.set_name("e\xcc\x81\nevent=forged " + std::string(1000, 'a'));
  const std::string name = ReadWorkerState(message)->name;
  EXPECT_EQ(name.size(), kNameBytesMax);
  EXPECT_EQ(name.substr(0, 15), "\xc3\xa9 event=forged");
  EXPECT_EQ(CleanName(name), name);
  EXPECT_EQ(CleanName("caf\xe9"), "caf\xef\xbf\xbd");
}

}  // namespace
}  // namespace tessera
