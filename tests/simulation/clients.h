// The clients of a simulated farm: they submit jobs until the farm has them, cancel one, pause and resume
// jobs and change priorities.
#pragma once

#include "tests/simulation/coordinator_process.h"
#include "tests/simulation/world.h"

namespace tessera {

class Clients {
 public:
  Clients(World& world, CoordinatorProcess& coordinator) : world_(world), coordinator_(coordinator) {}

  // Makes the jobs of the simulation, those of each data directory, and plans their submission. A client
  // waits while another directory than its own is in use.
  void Start();
  void PauseOrResumeSome();
  void ChangeSomePriority();
  // Resumes every job of the directory in use, again and again until the farm has them running.
  void ResumeAll();
  bool have_all_ended();
  // Whether the jobs of the directory in use have.
  bool have_present_ended() const;
  // The directory in use was restored to an earlier state: clients submit what it does not know.
  void NoteRestored();

 private:
  FrameSpec DrawFrame();
  std::vector<FrameRequest> DrawFrames(int number);
  void MakeJob(int number, size_t directory);
  void Submit(size_t job);
  void Cancel(size_t job);
  JobModel* SomeOpenJob();

  World& world_;
  CoordinatorProcess& coordinator_;
};

}  // namespace tessera
