// Everything that the command line of `tessera` can say.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "client/frame_range.h"
#include "renderer/scene/scene.h"

namespace tessera {

constexpr int kWorkersMax = 1024;         // processes or threads on one box: more is a mistake in typing
constexpr int kPathDepthMax = 1'000'000;  // bounces: beyond what any path survives

constexpr double kFramesPerSecondDefault = 24;  // of films
constexpr double kFramesPerSecondMin = 1e-3;    // slower than any time lapse

// The restart of a coordinator takes less; a wrong address should not cost more.
constexpr std::chrono::seconds kPatienceDefault{15};
constexpr int kPatienceMax_s = 7 * 24 * 3600;

constexpr const char* kCoordinatorAddressDefault = "127.0.0.1:7700";

// Parsed and checked once by ParseCommandLine, constant ever after. A member that a command does not take has
// its default.
struct Options {
  std::string command;  // "render", "submit", ...
  std::string scene;    // path of the scene file
  std::string output;   // path of the EXR; empty: named after the scene or the job, in the current folder;
                        // of a sequence a pattern (frame_names.h), as png
  std::string png;      // path of a tone-mapped copy to leave as well, or empty
  bool json = false;    // answers for machines
  std::optional<FrameRange> frames;      // of a sequence
  double fps = kFramesPerSecondDefault;  // frames of one animated scene in a second of its time

  // render
  int workers = 0;          // processes; 0: one
  int threads = 0;          // of each process; 0: share the cores between the processes
  bool in_process = false;  // no farm

  // render, submit
  double verify_share = 0;  // of the units, rendered by two workers who must agree

  // a farm's commands
  std::string coordinator;                                // HOST:PORT or unix:PATH
  std::chrono::milliseconds patience = kPatienceDefault;  // for a coordinator that does not answer
  std::string name;                                       // of the job; empty: the scene's
  int priority = 0;                                       // submit, priority: higher goes first
  bool watch = false;                                     // submit: follow the job until it ends
  std::set<std::string> required_tags;                    // submit: of the workers that may work for the job
  bool preview = false;                                   // fetch: what is there will do
  std::optional<int> frame;                               // fetch: this one of a sequence
  uint64_t job = 0;
  std::string worker;  // drain, release: the name of some, or the number of one

  // compare
  std::string picture_a, picture_b;
  double tolerance = 0;  // largest difference of two values that counts as equal

  RenderOptions render;
};

}  // namespace tessera
