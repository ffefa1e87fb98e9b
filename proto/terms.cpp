#include "proto/terms.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace tessera {

std::string WorkUnit::Text() const {
  return fmt::format("job {} frame {} tile {} samples {}", Number(job), frame, tile, range.Text());
}

std::string FarmId::Hex() const {
  return fmt::format("{:016x}{:016x}", high, low);
}

bool IsRegion(const Region& region) {
  return region.x0 >= 0 && region.x0 < region.x1 && region.x1 <= 1 && region.y0 >= 0 &&
         region.y0 < region.y1 && region.y1 <= 1;
}

PixelBounds PixelsOf(const Region& region, const FrameSpec& frame) {
  const auto before = [](float share, int size) {
    return static_cast<int>(std::floor(double{share} * size));
  };
  const auto after = [](float share, int size) { return static_cast<int>(std::ceil(double{share} * size)); };
  return {before(region.x0, frame.width), before(region.y0, frame.height), after(region.x1, frame.width),
          after(region.y1, frame.height)};
}

bool Overlap(const PixelBounds& a, const PixelBounds& b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

// Lengths go before texts and lists, so that no two requests give the same bytes. The spool names scenes by
// this digest: another form would make it ignore what is there.
Digest SceneKey(const Digest& package, const std::string& scene_file, const std::string& options,
                const FrameSpec& frame) {
  Sha256Stream stream;
  const auto add_text = [&](std::string_view text) {
    stream.Add(fmt::format("{}:", text.size()));
    stream.Add(text);
  };
  add_text(package.Hex());
  add_text(scene_file);
  add_text(options);
  const PixelBounds& crop = frame.crop;
  stream.Add(fmt::format("{} {} {} {} {} {} {} {} {} {:016x} {} {}\n", frame.width, frame.height, crop.x0,
                         crop.y0, crop.x1, crop.y1, frame.samples_per_pixel, frame.tile_size,
                         static_cast<int>(frame.exr_type), std::bit_cast<uint64_t>(frame.noise_threshold),
                         frame.channels.size(), frame.attributes.size()));
  for (const Channel& channel : frame.channels) {
    add_text(channel.name);
    stream.Add(fmt::format("{} {} {}\n", static_cast<int>(channel.type), static_cast<int>(channel.rule),
                           channel.is_written ? 1 : 0));
  }
  for (const auto& [name, value] : frame.attributes) {
    add_text(name);
    add_text(value);
  }
  // Frames without these keep the key that earlier releases gave them.
  if (frame.denoiser != Denoiser::kNone)
    stream.Add(fmt::format("denoiser {}\n", static_cast<uint32_t>(frame.denoiser)));
  if (frame.cryptomatte_levels != kCryptomatteLevelsDefault)
    stream.Add(fmt::format("cryptomatte levels {}\n", frame.cryptomatte_levels));
  return stream.Finish();
}

Digest PreparationKey(const JobOrder& order) {
  const SceneOrder& scene = order.scene;
  const FrameRange range = scene.frames.value_or(FrameRange{});
  return Sha256(fmt::format("{} {}:{} {} {} {}:{} {}:{} {} {} {} {} {:016x}", order.submission,
                            order.name.size(), order.name, order.priority, scene.package.Hex(),
                            scene.scene_file.size(), scene.scene_file, scene.options.size(), scene.options,
                            scene.frames ? 1 : 0, range.first, range.last, range.step,
                            std::bit_cast<uint64_t>(scene.frames_per_second)));
}

bool IsTag(std::string_view word) {
  const auto belongs = [](char c) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    return is_letter || (c >= '0' && c <= '9') || std::string_view("._-+:").find(c) != std::string_view::npos;
  };
  return !word.empty() && word.size() <= kTagBytesMax && std::all_of(word.begin(), word.end(), belongs);
}

const char* MessageLevelName(MessageLevel level) {
  switch (level) {
    case MessageLevel::kInfo: return "info";
    case MessageLevel::kWarning: return "warning";
    case MessageLevel::kError: return "error";
  }
  return "info";
}

const char* JobStateName(JobState state) {
  switch (state) {
    case JobState::kWaiting: return "waiting";
    case JobState::kRunning: return "running";
    case JobState::kPaused: return "paused";
    case JobState::kFinished: return "finished";
    case JobState::kFailed: return "failed";
    case JobState::kCancelled: return "cancelled";
    case JobState::kPreparing: return "preparing";
  }
  TESSERA_CHECK(false);
}

}  // namespace tessera
