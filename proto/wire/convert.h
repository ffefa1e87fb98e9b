// Between messages and the plain values of terms.h. Read... checks every limit and is the only way in: a
// value that it returned can be believed. An error (kBadInput) names the field. Write... never fails.
#pragma once

#include <vector>

#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

namespace proto {
class FrameSpec;
class FrameRequest;
class FramesAnswer;
class JobLogAnswer;
class JobSpec;
class JobStatus;
class Lease;
class LeaseId;
class PixelBounds;
class PreparationReport;
class PreparationRequest;
class ResultsRequest;
class SampleRange;
class SceneRequest;
class WorkUnit;
class WorkerDirective;
class WorkerState;
class WorkerStatus;
}  // namespace proto

Result<Digest> ReadDigest(const std::string& bytes, const char* field);
std::string WriteDigest(const Digest& digest);

// Empty bytes are no farm.
Result<FarmId> ReadFarmId(const std::string& bytes);
std::string WriteFarmId(FarmId farm);
LeaseId ReadLeaseId(const proto::LeaseId& message);
Result<PixelBounds> ReadPixelBounds(const proto::PixelBounds& message);
Result<SampleRange> ReadSampleRange(const proto::SampleRange& message);
Result<FrameSpec> ReadFrameSpec(const proto::FrameSpec& message);
Result<WorkUnit> ReadWorkUnit(const proto::WorkUnit& message);
Result<Lease> ReadLease(const proto::Lease& message);
Result<FrameRequest> ReadFrameRequest(const proto::FrameRequest& message);
Result<PreparationRequest> ReadPreparationRequest(const proto::PreparationRequest& message);
Result<PreparationReport> ReadPreparationReport(const proto::PreparationReport& message);
Result<SceneRequest> ReadSceneOrder(const proto::SceneRequest& message);
// Of a worker with another protocol version only what tells who it is, so that it can be refused by name.
Result<WorkerState> ReadWorkerState(const proto::WorkerState& message);
Result<WorkerDirective> ReadWorkerDirective(const proto::WorkerDirective& message);
Result<int32_t> ReadPriority(int32_t priority);
Result<JobSpec> ReadJobSpec(const proto::JobSpec& message);
Result<JobStatus> ReadJobStatus(const proto::JobStatus& message);
Result<std::vector<FrameStatus>> ReadFrameStatuses(const proto::FramesAnswer& message);
Result<JobLogPage> ReadJobLog(const proto::JobLogAnswer& message);
Result<WorkerStatus> ReadWorkerStatus(const proto::WorkerStatus& message);
// Text of people and other programs, in both directions (CleanText): what was written can be read, and what
// was read can be shown and written again. A reason or notice: at most kReasonBytesMax bytes.
std::string CleanReason(const std::string& text);
// The name of a job or worker or a version: in normalisation form C, at most kNameBytesMax bytes.
std::string CleanName(const std::string& text);

void Write(LeaseId value, proto::LeaseId& message);
void Write(const PixelBounds& value, proto::PixelBounds& message);
void Write(SampleRange value, proto::SampleRange& message);
void Write(const FrameSpec& value, proto::FrameSpec& message);
void Write(const WorkUnit& value, proto::WorkUnit& message);
void Write(const Lease& value, proto::Lease& message);
void Write(const FrameRequest& value, proto::FrameRequest& message);
void Write(const PreparationRequest& value, proto::PreparationRequest& message);
void Write(const PreparationReport& value, proto::PreparationReport& message);
void Write(const SceneRequest& value, proto::SceneRequest& message);
void Write(const WorkerState& value, proto::WorkerState& message);
void Write(const WorkerDirective& value, proto::WorkerDirective& message);
void Write(const JobSpec& value, proto::JobSpec& message);
void Write(const JobStatus& value, proto::JobStatus& message);
void Write(const std::vector<FrameStatus>& value, proto::FramesAnswer& message);
void Write(const JobLogPage& value, proto::JobLogAnswer& message);
void Write(const WorkerStatus& value, proto::WorkerStatus& message);

// The message of ReturnResults that goes before `results`.
proto::ResultsRequest Announcement(WorkerId worker, FarmId farm, const proto::ResultsRequest& results);

}  // namespace tessera
