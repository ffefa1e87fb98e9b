// A temporary folder and a farm of real processes in it. Throws if a step fails that a test depends on.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "tests/build_paths.h"
#include "tests/end_to_end/process.h"
#include "tests/sanitizers.h"

namespace tessera {

class EndToEnd : public testing::Test {
 protected:
  EndToEnd();
  ~EndToEnd() override;

  const std::string& folder() const { return folder_; }
  std::string Path(const std::string& name) const { return folder_ + "/" + name; }
  // Writes a file in the folder.
  std::string Write(const std::string& name, const std::string& text) const;
  std::string Bytes(const std::string& name) const;
  // The bytes of all files below a folder, which may change meanwhile; 0 if there is none.
  uint64_t BytesBelow(const std::string& name) const;
  bool Exists(const std::string& name) const;

  Outcome Tessera(const std::vector<std::string>& arguments) const {
    return RunProgram(folder_, "tessera", arguments);
  }
  // Renders in one process, as the reference. Returns the bytes of the EXR.
  std::string Oracle(const std::string& scene, std::vector<std::string> options);

  // Starts a coordinator on a free port of this machine, or restarts it on the port that it had. Programs of
  // the test reach it through its local socket.
  void StartCoordinator(const std::vector<std::string>& options = {});
  Process& coordinator() { return *coordinator_; }
  const std::string& address() const { return address_; }
  Process& StartWorker(const std::string& name, int threads = 1, std::vector<std::string> options = {});
  // A worker that is not given the address of the coordinator.
  Process& StartUnaddressedWorker(const std::string& name, std::vector<std::string> options);
  // `tessera COMMAND ... --coordinator ADDRESS`
  Outcome Ask(std::vector<std::string> arguments) const;
  // Submits a scene and returns the job id as printed.
  std::string Submit(const std::string& scene, std::vector<std::string> options);
  // A number in the output of `status --json`.
  double Figure(const std::string& job, const std::string& key) const;
  // Waits until more than this fraction of the job is done.
  void AwaitShare(const std::string& job, double share) const;
  // Kills a worker and the coordinator while a farm renders the box with these options, and expects the bytes
  // of one process in "picture.exr" after a restart. Returns the job.
  std::string ExpectSurvival(const std::vector<std::string>& options);

 private:
  std::string folder_;
  std::string address_ = "127.0.0.1:0";
  std::optional<Process> coordinator_;
  std::deque<Process> workers_;  // keeps references valid
};

// The scene that most tests render.
inline std::string BoxScene() {
  return SourceDir() + "/tests/scenes/box.pbrt";
}

// Options that make it a long render, so that an event at a quarter of the samples happens within the frame
// even on a loaded machine.
inline const std::vector<std::string> kLongRender{"--spp", std::to_string(1000 / kSlowdown)};

}  // namespace tessera
