// Processes of a coordinator, one after the other, on one disk: facts and, in place of the spool's files, the
// nodes that were synced. What is rendered is made up, and the same every time.
#pragma once

#include <gtest/gtest.h>

#include <map>

#include "coordinator/core/farm.h"
#include "renderer/film/adaptive.h"
#include "renderer/util/hash.h"
#include "tests/coordinator/core/former_lease.h"

namespace tessera {

using std::chrono::seconds;
constexpr int kTiles = 4;

// `frames` frames of 4 tiles.
inline std::shared_ptr<JobSpec> ExtendableJob(uint32_t samples, int frames = 1, bool extendable = true) {
  auto spec = std::make_shared<JobSpec>();
  spec->submission = 1;
  FrameSpec frame;
  frame.width = frame.height = 4;
  frame.crop = {0, 0, 4, 4};
  frame.tile_size = 2;
  frame.samples_per_pixel = samples;
  frame.channels = ColorsAndWeight({"R"});
  frame.attributes = {{kSamplesAttribute, std::to_string(samples)}, {kSamplerAttribute, "zsobol"}};
  for (int f = 0; f < frames; ++f)
    spec->frames.push_back({"s" + std::to_string(f), "", frame, f, extendable});
  return spec;
}

inline float Value(uint64_t place, SampleRange range) {
  if (range.size == 1) return UniformFloat(static_cast<uint32_t>(Hash(place, range.begin)));
  return Value(place, range.Left()) + Value(place, range.Right());
}

inline RadianceTile Rendered(const FrameSpec& spec, uint32_t frame, uint32_t tile, SampleRange range,
                             const PixelMask& pixels = {}) {
  RadianceTile rendered{spec.TileBounds(static_cast<int>(tile)), range, spec.Layout().shape(), {}};
  for (uint32_t i = 0; i < 8; ++i) {
    if (spec.IsAdaptive() && i % 2 == 1) rendered.sums.push_back(static_cast<float>(range.size));
    rendered.sums.push_back(Value(Hash(frame, tile, i), range));
  }
  if (spec.IsAdaptive()) KeepPixels(pixels, rendered);
  return rendered;
}

inline FramePicture Reference(const FrameSpec& spec, uint32_t frame) {
  Merger merger(spec);
  for (int tile = 0; tile < spec.TileCount(); ++tile) {
    for (auto missing = merger.Missing(tile); !missing.empty(); missing = merger.Missing(tile)) {
      for (const SampleRange range : missing)
        EXPECT_TRUE(merger.Add(tile, Rendered(spec, frame, static_cast<uint32_t>(tile), range)));
    }
  }
  return merger.Picture();
}

// What is on disk: it survives the farm.
struct Disk {
  std::vector<std::string> facts;
  std::map<FrameId, std::vector<TileNode>> base, results;
  std::chrono::milliseconds time_of_day{};  // when the next process begins, since 1970
};

struct Process {
  // Whether what is found in the spool is of this farm's scenes.
  enum class Contents { kRestored, kIgnored };
  explicit Process(Disk& disk, uint64_t kept_bytes_max = kKeptBytesMaxDefault,
                   Contents contents = Contents::kRestored)
      : disk(disk), contents(contents), farm(SchedulerOptions{kLaterEpoch}, kept_bytes_max) {
    for (const std::string& fact : disk.facts) farm.Restore(*DecodeFact(fact));
    std::set<FrameId> frames;
    for (const auto& [frame, nodes] : disk.base) frames.insert(frame);
    for (const auto& [frame, nodes] : disk.results) frames.insert(frame);
    for (const FrameId frame : frames) Find(frame);
    farm.Begin(now, disk.time_of_day);
    Step();
  }
  void Find(FrameId frame) {
    const auto use = farm.FoundInSpool(frame, !disk.results[frame].empty());
    if (use == Farm::SpoolUse::kDrop) Drop(frame);
    if (use != Farm::SpoolUse::kRestore || contents == Contents::kIgnored) return;
    for (const auto* nodes : {&disk.base[frame], &disk.results[frame]}) {
      for (const TileNode& node : *nodes) farm.RestoreNode(frame, node);
    }
  }
  void Drop(FrameId frame) {
    disk.base.erase(frame);
    disk.results.erase(frame);
  }
  // As the core thread does it.
  void Step() {
    farm.Advance(now);
    FarmOutput output = farm.TakeOutput();
    for (const auto& [frame, node] : output.accepted) disk.results[frame].push_back(node);
    for (const Fact& fact : output.facts) disk.facts.push_back(EncodeFact(fact));
    for (const FinishedPicture& picture : output.pictures) pictures.push_back(picture);
    for (auto& [frame, nodes] : output.sums) {
      disk.base[frame] = nodes;
      disk.results.erase(frame);
    }
    for (const FrameId frame : output.dropped) Drop(frame);
    for (const FrameId frame : output.loads) loads.push_back(frame);
    log.insert(log.end(), output.log.begin(), output.log.end());
    last = std::move(output.results);
  }
  Verdict Return(JobId job, uint32_t frame, uint32_t tile, SampleRange range, const PixelMask& pixels = {}) {
    const FrameSpec& spec = farm.Spec(job)->frames[frame].spec;
    const RadianceTile rendered = Rendered(spec, frame, tile, range, pixels);
    const WorkUnit unit{job, frame, tile, range, *farm.SceneOf({job, frame})};
    JoinWithFormerLease(farm, now, CallId{++calls}, WorkerId{1}, unit);
    farm.ReturnResults(now, CallId{++calls}, WorkerId{1}, {{FormerLease(), unit, 0.1, rendered}});
    Step();
    return last[0].verdicts[0];
  }
  void ReturnAll(JobId job, uint32_t frame, uint32_t begin, uint32_t samples) {
    for (uint32_t tile = 0; tile < kTiles; ++tile) {
      for (uint32_t s = begin; s < samples;) {
        const SampleRange range{s, DyadicSizeMax(s, samples)};
        Return(job, frame, tile, range);
        s = range.end();
      }
    }
  }
  void WritePictures() {
    for (const FinishedPicture& each : pictures)
      farm.PictureWritten(now, {each.job, each.frame}, {Sha256("file"), 4});
    Step();
  }
  void Load() {
    for (const FrameId frame : std::exchange(loads, {})) {
      std::vector<TileNode> nodes = disk.base[frame];
      for (const TileNode& node : disk.results[frame]) nodes.push_back(node);
      farm.SumsLoaded(now, frame, std::move(nodes));
    }
    Step();
  }
  // Renders a job's only frame to its end.
  void Finish(JobId job, uint32_t samples) {
    ReturnAll(job, 0, 0, samples);
    WritePictures();
    pictures.clear();
  }
  JobStatus Status(JobId job) { return *farm.Status(now, job); }

  Instant now = seconds(100);
  Disk& disk;
  Contents contents;
  Farm farm;
  std::vector<FinishedPicture> pictures;
  std::vector<FrameId> loads;
  std::vector<std::string> log;
  std::vector<FarmOutput::Results> last;
  uint64_t calls = 0;
};

}  // namespace tessera
