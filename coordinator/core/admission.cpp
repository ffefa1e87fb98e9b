#include "coordinator/core/admission.h"

#include <fmt/format.h>

#include "proto/probe.h"

namespace tessera {
namespace {

std::string Hexadecimal(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  return text;
}

}  // namespace

Result<void> CheckRelease(const WorkerState& state) {
  if (state.protocol != kProtocolVersion) {
    return Failed(
        fmt::format("worker \"{}\" uses protocol {}, this coordinator {}; install the same release on both",
                    state.name, state.protocol, kProtocolVersion));
  }
  if (state.software_version != kSoftwareVersion) {
    return Failed(
        fmt::format("worker \"{}\" has version {}, this coordinator {}; install the same release on both",
                    state.name, state.software_version, kSoftwareVersion));
  }
  const std::string digest = Hexadecimal(state.probe_digest);
  if (digest.empty()) {
    return Failed(
        fmt::format("worker \"{}\" has not rendered the probe unit, whose digest must be {}; install "
                    "the same release on both",
                    state.name, kProbeDigest));
  }
  if (digest != kProbeDigest) {
    return Failed(
        fmt::format("worker \"{}\" renders different pixels: its probe unit has digest {}, expected {}; "
                    "check its processor, system libraries and build",
                    state.name, digest, kProbeDigest));
  }
  return {};
}

}  // namespace tessera
