// Writes the seeds of the formats that only Tessera writes: run it after adding a kind of fact, a message or
// a version of a format, and add the new files to tests/fuzz/corpus. Usage: make_seeds FOLDER
#include <google/protobuf/message.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "coordinator/core/fact.h"
#include "coordinator/store/file_journal.h"
#include "coordinator/store/node_log.h"
#include "proto/blobs.pb.h"
#include "proto/jobs.pb.h"
#include "proto/terms.pb.h"
#include "proto/wire/convert.h"
#include "proto/work.pb.h"
#include "renderer/film/picture_file.h"
#include "renderer/film/radiance_tile.h"
#include "tests/fuzz/small_frame.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

fs::path folder;

void Save(const char* target, const std::string& name, const std::string& bytes) {
  fs::create_directories(folder / target);
  std::ofstream(folder / target / name, std::ios::binary) << bytes;
}

void SaveMessage(const char* target, const std::string& type, const char* file_name,
                 const google::protobuf::MessageLite& message) {
  Save(target, file_name, type + "\n" + message.SerializeAsString());
}

FrameSpec RichFrame() {
  FrameSpec frame = SmallFrame();
  frame.exr_type = ExrType::kFloat;
  frame.SetNoiseThreshold(0.125);
  frame.attributes = {{"owner", "studio"}, {"comments", ""}};
  return frame;
}

JobSpec Job() {
  JobSpec job;
  job.submission = 7;
  job.name = "shot";
  job.package = Sha256("package");
  job.frames = {{"scene.pbrt", "spp=4\n", SmallFrame(), 1, true}, {"b/scene.pbrt", "", RichFrame(), -2}};
  job.required_tags = {"gpu"};
  job.verify_share = 0.25;
  job.first = Region{0.25f, 0.75f, 0, 0.5f};
  return job;
}

JobOrder Order() {
  return {8, "shot", 2, {Sha256("package"), "b/scene.##.pbrt", "spp=4\n", FrameRange{1, 9, 2}, 25}};
}

WorkUnit Unit() {
  return {JobId{1}, 0, 2, {4, 4}, Sha256("scene")};
}

void SaveTiles() {
  RadianceTile tile;
  tile.bounds = {2, 1, 5, 3};
  tile.range = {4, 4};
  tile.shape = {4, 0, 0};
  tile.sums.assign(6 * 4, 0.5f);
  Save("radiance_tile", "sums", EncodeRadianceTile(tile));
  std::fill(tile.sums.begin(), tile.sums.begin() + 8, 0.0f);
  Save("radiance_tile", "masked", EncodeRadianceTile(tile));
  tile.shape = {4, 2, 0};
  tile.sums.assign(6 * 6, 1.25f);
  Save("radiance_tile", "nearest_by_depth", EncodeRadianceTile(tile));
  tile.shape = {1, 0, 2};  // the sizes of two sets of ids in each record
  tile.bounds = {0, 0, 2, 1};
  tile.sums = {1, 2, 0, 1, 1, 1, 3.5f, 1, 4.5f, 2, 5.5f, 1, 6.5f, 4};
  Save("radiance_tile", "ids", EncodeRadianceTile(tile));
  tile.shape = {4, 1, 1};
  tile.bounds = {0, 0, 3, 1};
  tile.sums = {1, 1, 1, 1, 7, 1, 0, 0, 0, 0, 0, 0, 2, 2, 2, 2, 8, 1, 3.5f, 1, 4.5f, 2};
  Save("radiance_tile", "masked_ids_and_depth", EncodeRadianceTile(tile));
}

void SavePictures() {
  for (const auto& [name, frame] : {std::pair("half", SmallFrame()), std::pair("float", RichFrame())}) {
    FramePicture picture;
    picture.bounds = frame.crop;
    for (const PictureChannel& channel : frame.PictureChannels()) picture.channels.push_back(channel.name);
    picture.values.resize(static_cast<size_t>(frame.crop.area()) * picture.channels.size());
    for (size_t i = 0; i < picture.values.size(); ++i) picture.values[i] = static_cast<float>(i) * 0.25f;
    const auto bytes = EncodeExr(frame, picture);
    TESSERA_CHECK(bytes.has_value());
    Save("picture", name, *bytes);
  }
}

void SaveFacts() {
  const Fact facts[] = {CoordinatorStarted{3, {5, 6}},
                        JobSubmitted{JobId{1}, std::make_shared<const JobSpec>(Job())},
                        FrameFinished{JobId{1}, 0, {Sha256("picture"), 4096}, 512},
                        FrameFailed{JobId{1}, 0, "out of memory"},
                        JobEnded{JobId{1}, JobState::kFailed, "out of memory"},
                        JobExtended{JobId{1}, 64},
                        JobsForgotten{JobId{1}},
                        FrameResumed{JobId{1}, 0},
                        JobPaused{JobId{1}, true},
                        JobPriorityChanged{JobId{1}, -3},
                        JobOwned{JobId{1}, {MemberId{7}, "ada"}},
                        AuthorityChosen{Sha256("authority")},
                        WorkerQuarantined{WorkerId{9}, "blade", true, "disagrees"},
                        VoteRecorded{Unit(), WorkerId{9}, "blade", Sha256("result")},
                        UnitsCounted{JobId{1}, 1, 2, 3},
                        JobOrdered{JobId{1}, std::make_shared<const JobOrder>(Order())},
                        JobTimed{JobId{1}, 1'700'000'000'000, {}, {}},
                        JobTimed{JobId{2}, 1'700'000'000'000, 1'700'000'060'000, {1, 2, 3}}};
  const fs::path path = folder / "journal" / "facts";
  fs::create_directories(path.parent_path());
  fs::remove(path);
  auto journal = FileJournal::Open(path, [](const Fact&) {});
  TESSERA_CHECK(journal.has_value());
  for (const Fact& fact : facts) {
    Save("fact", std::to_string(fact.index()), EncodeFact(fact));
    (*journal)->Append(fact);
    TESSERA_CHECK((*journal)->Sync().has_value());
  }
}

void SaveSpool() {
  const fs::path path = folder / "spool" / "nodes";
  fs::create_directories(path.parent_path());
  const auto log = NodeLog::Create(path, {Sha256("scene"), {}});
  TESSERA_CHECK(log.has_value());
  const auto channels = std::make_shared<const std::vector<Channel>>(SmallFrame().channels);
  const PixelShape shape = SmallFrame().Layout().shape();
  std::vector<float> values(4 * shape.stride(), 0.5f);
  for (size_t pixel = 0; pixel < 4; ++pixel) values[(pixel + 1) * shape.stride() - 1] = pixel == 2 ? 2 : 0;
  for (const float entry : {3.5f, 0.25f, 4.5f, 0.25f}) values.push_back(entry);  // ids of the third pixel
  for (const SampleRange range : {SampleRange{0, 2}, SampleRange{2, 2}, SampleRange{4, 4}}) {
    (*log)->Append({1, range, SharedSums(std::vector<float>(values)), channels});
    TESSERA_CHECK((*log)->Sync().has_value());
  }
}

proto::WorkerState State() {
  WorkerState state;
  state.worker = WorkerId{5};
  state.farm = {5, 6};
  state.sequence = 1;
  state.name = "blade";
  state.slots = 4;
  state.build_digest = std::string(32, 'b');
  state.probe_digest = std::string(32, 'p');
  state.tags = {"gpu"};
  state.scenes = {{Sha256("scene"), true, false}, {Sha256("other"), false, true}};
  state.leases = {{{3, 4}, Unit(), LeaseStage::kRunning, std::chrono::milliseconds(20)}};
  state.returned_leases = {{1, 4}};
  state.preparations = {PreparationKey(Order())};
  state.wait = std::chrono::milliseconds(500);
  proto::WorkerState message;
  Write(state, message);
  return message;
}

proto::ResultsRequest Results() {
  RadianceTile tile;
  tile.bounds = {0, 0, 1, 1};
  tile.range = {4, 4};
  tile.shape = {4, 0, 0};
  tile.sums.assign(4, 0.5f);
  proto::ResultsRequest message;
  proto::UnitResult& result = *message.add_results();
  Write({3, 4}, *result.mutable_lease());
  Write(Unit(), *result.mutable_unit());
  result.set_tile(EncodeRadianceTile(tile));
  result.set_render_seconds(0.5);
  return message;
}

void SaveRequestsAboutJobs() {
  proto::JobSpec job;
  Write(Job(), job);
  SaveMessage("request", "Jobs.Submit", "submit", job);
  proto::JobRequest number;
  number.set_job(3);
  SaveMessage("request", "Jobs.Status", "status", number);
  proto::ExtendRequest extend;
  extend.set_job(3);
  extend.set_samples_per_pixel(64);
  SaveMessage("request", "Jobs.Extend", "extend", extend);
  proto::PriorityRequest priority;
  priority.set_job(3);
  priority.set_priority(-4);
  SaveMessage("request", "Jobs.SetPriority", "priority", priority);
  proto::WorkersRequest workers;
  workers.set_which("bl\xc3\xa4tt");
  SaveMessage("request", "Jobs.DrainWorkers", "workers", workers);
  proto::FetchRequest fetch;
  fetch.set_job(3);
  fetch.set_preview(true);
  SaveMessage("request", "Jobs.FetchPicture", "fetch", fetch);
}

void SaveRequestsOfWorkers() {
  SaveMessage("request", "Work.Synchronize", "synchronize", State());
  SaveMessage("request", "Work.ReturnResults", "results", Results());
  SaveMessage("request", "Work.ReturnResults", "announcement", Announcement(WorkerId{5}, {5, 6}, Results()));
  proto::FailureRequest failure;
  failure.set_worker(5);
  Write({3, 4}, *failure.mutable_lease());
  Write(Unit(), *failure.mutable_unit());
  failure.set_farm(WriteFarmId({5, 6}));
  failure.set_reason("out of memory\n");
  SaveMessage("request", "Work.ReturnFailure", "failure", failure);
  PreparationReport made{PreparationKey(Order()), Job().frames, {"nothing moves"}, "", {5, 6}};
  proto::PreparationReport prepared, refused;
  Write(made, prepared);
  SaveMessage("request", "Work.ReturnPreparation", "prepared", prepared);
  made.frames.clear();
  made.reason = "scene.pbrt:3:1: unknown directive";
  Write(made, refused);
  SaveMessage("request", "Work.ReturnPreparation", "not_prepared", refused);
}

void SaveRequestsAboutBlobs() {
  proto::FindMissingRequest find;
  find.add_digests(WriteDigest(Sha256("blob")));
  SaveMessage("request", "Blobs.FindMissing", "find_missing", find);
  proto::UploadChunk chunk;
  chunk.set_digest(WriteDigest(Sha256("blob")));
  chunk.set_size(4);
  chunk.set_data("blob");
  SaveMessage("request", "Blobs.Upload", "upload", chunk);
  proto::DownloadRequest download;
  download.set_digest(WriteDigest(Sha256("blob")));
  download.set_offset(2);
  SaveMessage("request", "Blobs.Download", "download", download);
}

void SaveAnswersToWorkers() {
  WorkerDirective directive;
  SceneRequest scene{{}, Sha256("package"), "scene.pbrt", "spp=4\n", RichFrame(), true};
  scene.key = SceneKey(scene.package, scene.scene_file, scene.options, scene.frame);
  const Lease all{{3, 4}, Unit(), {0, 0, 2, 2}, {}, std::chrono::milliseconds(1000)};
  Lease some = all;
  some.pixels = PixelMask::Of({true, false, false, true});
  directive.scenes = {scene};
  directive.leases = {all, some};
  directive.drop = {{1, 4}};
  directive.prefetch = {Sha256("package")};
  directive.preparation = PreparationRequest{PreparationKey(Order()), Order().scene};
  directive.call_again = std::chrono::milliseconds(100);
  directive.notice = "quarantined";
  directive.farm = {5, 6};
  proto::WorkerDirective message;
  Write(directive, message);
  SaveMessage("answer", "WorkerDirective", "directive", message);
  proto::Lease lease;
  Write(some, lease);
  SaveMessage("answer", "Lease", "lease", lease);
}

void SaveAnswersToClients() {
  JobStatus status;
  status.job = JobId{3};
  status.name = "shot";
  status.state = JobState::kPaused;
  status.reason = "the disk is full";
  status.samples_total = 512;
  status.times.render_s = 1.5;
  proto::JobStatus job;
  Write(status, job);
  SaveMessage("answer", "JobStatus", "job", job);
  proto::FramesAnswer frames;
  Write({{1, std::nullopt}, {2, Sha256("picture")}}, frames);
  SaveMessage("answer", "FramesAnswer", "frames", frames);
  WorkerStatus worker;
  worker.worker = WorkerId{5};
  worker.name = "blade";
  worker.slots = 4;
  worker.tags = {"gpu"};
  worker.utilisation = 0.5;
  proto::WorkerStatus message;
  Write(worker, message);
  SaveMessage("answer", "WorkerStatus", "worker", message);
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  using namespace tessera;
  if (argc != 2) {
    std::fputs("usage: make_seeds FOLDER\n", stderr);
    return 2;
  }
  folder = argv[1];
  SaveTiles();
  SavePictures();
  SaveFacts();
  SaveSpool();
  SaveRequestsAboutJobs();
  SaveRequestsOfWorkers();
  SaveRequestsAboutBlobs();
  SaveAnswersToWorkers();
  SaveAnswersToClients();
}
