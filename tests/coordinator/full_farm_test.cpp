// A farm that has as many workers as it may have.
#include <gmock/gmock.h>
#include <grpcpp/support/status.h>
#include <gtest/gtest.h>

#include "coordinator/core/farm.h"
#include "coordinator/core/schedule/policy.h"
#include "coordinator/work_service.h"
#include "proto/probe.h"

namespace tessera {
namespace {

using grpc::StatusCode;

WorkerState Worker(uint64_t id) {
  WorkerState state;
  state.worker = WorkerId{id};
  state.sequence = 1;
  state.name = "w";
  const Digest probe = *Digest::FromHex(kProbeDigest);
  state.probe_digest.assign(probe.bytes.begin(), probe.bytes.end());
  return state;
}

TEST(FullFarm, RefusesAnotherWorkerForNowAndAWrongReleaseForEver) {
  Farm farm({}, 0, FarmId{1, 2});
  const Instant now = std::chrono::hours(1);
  farm.Begin(now);
  for (uint64_t id = 1; id <= kWorkersMax; ++id) {
    ASSERT_TRUE(CheckJoin(farm, Worker(id)).ok()) << id;
    farm.Synchronize(now, CallId{id}, Worker(id));
  }
  const grpc::Status full = CheckJoin(farm, Worker(kWorkersMax + 1));
  EXPECT_EQ(full.error_code(), StatusCode::RESOURCE_EXHAUSTED) << "it may try again";
  EXPECT_THAT(full.error_message(), testing::HasSubstr("the farm is full: it has 100000 workers"));
  EXPECT_TRUE(CheckJoin(farm, Worker(5)).ok()) << "those that have joined stay";
  WorkerState wrong = Worker(kWorkersMax + 1);
  wrong.protocol = 1;
  EXPECT_EQ(CheckJoin(farm, wrong).error_code(), StatusCode::FAILED_PRECONDITION) << "it never can";
}

}  // namespace
}  // namespace tessera
