// An open folder. Its files are reached through its descriptor, not by its name, so that renaming it or
// putting a link in its place has no effect. Thread safe.
#pragma once

#include <memory>
#include <string>

#include "renderer/util/result.h"

namespace tessera {

class BlobFolder {
 public:
  // Takes the descriptor of a folder with this name, for messages.
  BlobFolder(int descriptor, std::string name);
  ~BlobFolder();
  BlobFolder(const BlobFolder&) = delete;
  BlobFolder& operator=(const BlobFolder&) = delete;

  static Result<std::shared_ptr<const BlobFolder>> Open(const std::string& name);

  const std::string& name() const { return name_; }
  // A path for system calls of this process and its children, whatever the folder is called now.
  const std::string& location() const { return location_; }
  // `text` with the folder's name instead of its location, for messages.
  std::string Named(std::string text) const;
  Error Named(Error error) const { return {error.kind, Named(std::move(error.message))}; }

 private:
  int descriptor_;
  std::string name_, location_;
};

}  // namespace tessera
