#include "proto/terms.h"

#include <fmt/format.h>

#include <algorithm>

namespace tessera {

std::string WorkUnit::Text() const {
  return fmt::format("job {} frame {} tile {} samples {}", Number(job), frame, tile, range.Text());
}

Digest SceneKey(const Digest& package, const std::string& scene_file, const std::string& options) {
  Sha256Stream stream;
  stream.Add(package.Hex());
  // Lengths before the texts, so that no two triples give the same bytes.
  stream.Add(fmt::format("\n{} {}\n", scene_file.size(), options.size()));
  stream.Add(scene_file);
  stream.Add(options);
  return stream.Finish();
}

bool IsTag(std::string_view word) {
  const auto belongs = [](char c) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    return is_letter || (c >= '0' && c <= '9') || std::string_view("._-+:").find(c) != std::string_view::npos;
  };
  return !word.empty() && word.size() <= kTagBytesMax && std::all_of(word.begin(), word.end(), belongs);
}

const char* JobStateName(JobState state) {
  switch (state) {
    case JobState::kWaiting: return "waiting";
    case JobState::kRunning: return "running";
    case JobState::kPaused: return "paused";
    case JobState::kFinished: return "finished";
    case JobState::kFailed: return "failed";
    case JobState::kCancelled: return "cancelled";
  }
  TESSERA_CHECK(false);
}

}  // namespace tessera
