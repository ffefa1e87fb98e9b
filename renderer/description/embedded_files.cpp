#include "renderer/description/embedded_files.h"

namespace tessera {

Result<std::string> SceneFileSource::Read(const std::string& name) {
  const auto found = embedded_->find(name);
  return found != embedded_->end() ? Result<std::string>(*found->second) : outside_->Read(name);
}

std::optional<Digest> SceneFileSource::Identify(const std::string& name) {
  const auto found = embedded_->find(name);
  return found != embedded_->end() ? Sha256(*found->second) : outside_->Identify(name);
}

}  // namespace tessera
