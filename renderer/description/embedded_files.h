// Files that a scene carries in itself, such as the images of a binary glTF file.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "renderer/description/file_source.h"

namespace tessera {

// By the names that the scene's parameters use, with the ending of their format ("image0.png"). Never null.
using EmbeddedFiles = std::map<std::string, std::shared_ptr<const std::string>>;

// A scene's embedded files in front of the files of another source, whose cache it shares. Thread safe.
class SceneFileSource : public FileSource {
 public:
  // Both must outlive this.
  SceneFileSource(FileSource& outside, const EmbeddedFiles& embedded)
      : FileSource(outside.cache()), outside_(&outside), embedded_(&embedded) {}
  Result<std::string> Read(const std::string& name) override;
  std::optional<Digest> Identify(const std::string& name) override;

 private:
  FileSource* outside_;
  const EmbeddedFiles* embedded_;
};

}  // namespace tessera
