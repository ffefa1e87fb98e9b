// The clients of a simulated farm: they submit jobs until the farm has them, cancel one, pause and resume
// jobs and change priorities.
#pragma once

#include "tests/simulation/coordinator_process.h"
#include "tests/simulation/world.h"

namespace tessera {

class Clients {
 public:
  Clients(World& world, CoordinatorProcess& coordinator) : world_(world), coordinator_(coordinator) {}

  // Makes the jobs of the simulation and plans their submission.
  void Start();
  void PauseOrResumeSome();
  void ChangeSomePriority();
  // Resumes every job, again and again until the farm has heard it.
  void ResumeAll();
  bool have_all_ended();

 private:
  FrameSpec DrawFrame();
  void MakeJob(int number);
  void Submit(size_t job);
  void Cancel(size_t job);
  JobModel* SomeOpenJob();

  World& world_;
  CoordinatorProcess& coordinator_;
};

}  // namespace tessera
