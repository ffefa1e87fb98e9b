// What all parts of a simulation share: time, chance, the network, the jobs, the trace and the report.
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "proto/terms.h"
#include "renderer/film/merger.h"
#include "renderer/util/digest.h"
#include "tests/simulation/event_queue.h"
#include "tests/simulation/random.h"
#include "tests/simulation/simulation_options.h"

namespace tessera {

// A job and what an observer knows of it.
struct JobModel {
  size_t directory = 0;  // the data directory whose farm its client uses
  JobId id{};            // as the farm last journalled it; 0: it has not
  std::shared_ptr<const JobSpec> spec;
  std::vector<Digest> scenes;          // SceneKey of each frame
  std::vector<Merger> reference;       // of each frame: everything merged by one machine
  std::vector<FramePicture> pictures;  // of the reference
  double cost = 0;                     // seconds per pixel sample
  bool is_ordered = false;             // a worker makes its frames
  bool is_poisoned = false;            // has a unit that every worker fails
  bool is_killer = false;              // has a unit that kills every worker that renders it
  bool is_acknowledged = false;        // the client knows that the farm has it
  bool is_cancelled = false;           // the client asked for it
  JobState told = JobState::kWaiting;  // the last state that was on stable storage
};

struct SimulationReport {
  std::vector<std::string> violations;  // of invariants; empty if all held
  Digest trace;                         // of everything that happened
  double ended_s = 0;                   // when the last job ended
  uint64_t samples_rendered = 0, samples_needed = 0;
  int results = 0, refused = 0, duplicates = 0, crashes = 0;
  int ends_on_full_disk = 0;  // of jobs that were not finished
};

class World {
 public:
  // `on_trace`, if any, gets everything that happens, line by line.
  using OnTrace = std::function<void(const std::string& line)>;
  using Deliver = std::function<void()>;
  World(uint64_t seed, SimulationOptions simulation_options, OnTrace on_trace);

  void Trace(const std::string& line);
  void Violation(const std::string& what);
  // Whether the time of faults is over.
  bool is_healthy() const { return Seconds(queue.now()) >= options.faults_s; }
  // A message: loses, repeats, reorders and delays it until the farm heals.
  void Send(Deliver deliver);
  // The job of the data directory that is in use. Returns nullptr if no job has the id.
  JobModel* ModelOf(JobId id);
  // A frame of any job, by what it is rendered from.
  struct FrameModel {
    const JobModel* job = nullptr;
    uint32_t frame = 0;
  };
  FrameModel FrameOf(const Digest& scene) const;
  // Names the present contents of the directory in use: what was said about them may be wrong in another
  // history.
  std::pair<size_t, uint64_t> history() const { return {directory, restored}; }
  SimulationReport TakeReport();

  const SimulationOptions options;
  Random random;
  EventQueue queue;
  std::vector<JobModel> jobs;
  size_t directory = 0;               // the data directory in use
  uint64_t restored = 0;              // how often any has been restored to an earlier state
  int deaths = 0;                     // of single workers
  std::set<WorkerId> faulty_workers;  // that fail units, damage results or return wrong ones
  SimulationReport report;

 private:
  OnTrace on_trace_;
  Sha256Stream trace_;
};

}  // namespace tessera
