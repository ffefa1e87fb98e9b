// Conversions of scenes that workers prepare, and of the frames that come of it.
#include "proto/terms.pb.h"
#include "proto/wire/convert.h"
#include "proto/wire/fields.h"
#include "proto/work.pb.h"

namespace tessera {

Result<FrameRequest> ReadFrameRequest(const proto::FrameRequest& message) {
  if (!IsPackagePath(message.scene_file())) return BadField("scene_file", "is not a path in a package");
  if (message.options().size() > kOptionsBytesMax) return BadField("options", "are too long");
  auto spec = ReadFrameSpec(message.spec());
  if (!spec) return spec.error();
  return FrameRequest{message.scene_file(), message.options(), std::move(*spec), message.number(),
                      message.extendable()};
}

void Write(const FrameRequest& value, proto::FrameRequest& message) {
  message.set_scene_file(value.scene_file);
  message.set_options(value.options);
  Write(value.spec, *message.mutable_spec());
  message.set_number(value.number);
  message.set_extendable(value.extendable);
}

Result<PreparationRequest> ReadPreparationRequest(const proto::PreparationRequest& message) {
  const auto key = ReadDigest(message.key(), "key");
  if (!key) return key.error();
  const auto package = ReadDigest(message.package(), "package");
  if (!package) return package.error();
  PreparationRequest request{
      *key, {*package, message.scene_file(), message.options(), std::nullopt, message.frames_per_second()}};
  const uint32_t last = message.last(), step = message.step();
  if (last > static_cast<uint32_t>(kFrameNumberMax) || step > static_cast<uint32_t>(kFrameNumberMax) ||
      message.first() > last)
    return BadField("frames", "are not a range");
  if (message.is_sequence())
    request.scene.frames =
        FrameRange{static_cast<int>(message.first()), static_cast<int>(last), static_cast<int>(step)};
  if (const auto checked = CheckSceneOrder(request.scene); !checked)
    return BadInput("message refused: " + checked.error().message);
  return request;
}

void Write(const PreparationRequest& value, proto::PreparationRequest& message) {
  message.set_key(WriteDigest(value.key));
  message.set_package(WriteDigest(value.scene.package));
  message.set_scene_file(value.scene.scene_file);
  message.set_options(value.scene.options);
  message.set_frames_per_second(value.scene.frames_per_second);
  message.set_is_sequence(value.scene.frames.has_value());
  if (!value.scene.frames) return;
  message.set_first(static_cast<uint32_t>(value.scene.frames->first));
  message.set_last(static_cast<uint32_t>(value.scene.frames->last));
  message.set_step(static_cast<uint32_t>(value.scene.frames->step));
}

Result<PreparationReport> ReadPreparationReport(const proto::PreparationReport& message) {
  PreparationReport report;
  const auto farm = ReadFarmId(message.farm());
  if (!farm) return farm.error();
  report.farm = *farm;
  const auto key = ReadDigest(message.key(), "key");
  if (!key) return key.error();
  report.key = *key;
  report.reason = CleanReason(message.reason());
  if (report.reason.empty() == (message.frames_size() == 0))
    return BadField("report", "has neither frames nor a reason, or both");
  if (message.frames_size() > kFramesPerJobMax) return BadField("frames", "are too many for one job");
  for (const auto& each : message.frames()) {
    auto frame = ReadFrameRequest(each);
    if (!frame) return frame.error();
    report.frames.push_back(std::move(*frame));
  }
  if (message.warnings_size() > kPreparationWarningsMax) return BadField("warnings", "are too many");
  for (const std::string& warning : message.warnings()) report.warnings.push_back(CleanReason(warning));
  return report;
}

void Write(const PreparationReport& value, proto::PreparationReport& message) {
  message.set_farm(WriteFarmId(value.farm));
  message.set_key(WriteDigest(value.key));
  for (const FrameRequest& frame : value.frames) Write(frame, *message.add_frames());
  for (const std::string& warning : value.warnings) message.add_warnings(CleanReason(warning));
  message.set_reason(CleanReason(value.reason));
}

}  // namespace tessera
