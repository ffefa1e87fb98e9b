#include "tests/simulation/simulated_spool.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr size_t kSegmentNodesMax = 6;  // few, so that small frames are replaced too

}  // namespace

void SimulatedSpool::Files::PutBase() {
  if (!next) return;
  const size_t covered = std::min(next->covers, segment.size());
  segment.erase(segment.begin(), segment.begin() + static_cast<std::ptrdiff_t>(covered));
  const size_t pending_covered = next->covers - covered;
  pending.erase(pending.begin(), pending.begin() + static_cast<std::ptrdiff_t>(pending_covered));
  base = std::move(next->nodes);
  next.reset();
}

void SimulatedSpool::Append(FrameId frame, TileNode node) {
  files_[frame].pending.push_back(std::move(node));
}

Result<void> SimulatedSpool::Sync() {
  const bool idle = std::ranges::all_of(files_, [](const auto& each) { return each.second.pending.empty(); });
  if (full_) return idle ? Result<void>{} : Failed("no space left on device");
  for (auto& [frame, files] : files_) {
    files.segment.insert(files.segment.end(), files.pending.begin(), files.pending.end());
    files.pending.clear();
    files.PutBase();
  }
  dropped_.clear();
  return {};
}

std::vector<FrameId> SimulatedSpool::Grown() const {
  std::vector<FrameId> grown;
  for (const auto& [frame, files] : files_) {
    if (files.segment.size() > kSegmentNodesMax && !files.next) grown.push_back(frame);
  }
  return grown;
}

void SimulatedSpool::Replace(FrameId frame, std::vector<TileNode> nodes) {
  Files& files = files_[frame];
  files.next = Base{std::move(nodes), files.segment.size() + files.pending.size()};
}

void SimulatedSpool::Drop(FrameId frame) {
  if (auto found = files_.extract(frame)) dropped_[frame] = std::move(found.mapped());
}

void SimulatedSpool::Load(FrameId frame, OnLoaded done) {
  if (!files_.contains(frame)) return done(Failed("the frame is not in the spool"));
  done(Nodes(frame));
}

void SimulatedSpool::Crash(Random& random) {
  for (auto& [frame, files] : std::exchange(dropped_, {})) {
    if (random.Chance(0.5)) files_.try_emplace(frame, std::move(files));
  }
  for (auto& [frame, files] : files_) {
    if (random.Chance(0.5)) files.PutBase();
    files.next.reset();
    files.pending.resize(static_cast<size_t>(random.Int(0, static_cast<int>(files.pending.size()))));
    files.segment.insert(files.segment.end(), files.pending.begin(), files.pending.end());
    files.pending.clear();
  }
  std::erase_if(files_,
                [](const auto& each) { return each.second.base.empty() && each.second.segment.empty(); });
}

std::vector<FrameId> SimulatedSpool::Frames() const {
  std::vector<FrameId> frames;
  for (const auto& [frame, files] : files_) frames.push_back(frame);
  return frames;
}

std::vector<TileNode> SimulatedSpool::Nodes(FrameId frame) const {
  const Files& files = files_.at(frame);
  std::vector<TileNode> nodes = files.base;
  nodes.insert(nodes.end(), files.segment.begin(), files.segment.end());
  return nodes;
}

}  // namespace tessera
