// Sends bytes from a temporary file without a name: they take no memory while a slow reader takes them.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "coordinator/web/http_response.h"
#include "proto/shell/rare_log.h"
#include "renderer/util/file_descriptor.h"
#include "renderer/util/result.h"

namespace tessera {

class FileStream final : public BodyStream {
 public:
  // An error if the folder has no room for them.
  static Result<std::shared_ptr<FileStream>> Make(const std::string& folder, std::string_view bytes);
  FileStream(FileDescriptor file, uint64_t size) : file_(std::move(file)), size_(size) {}

  Next Take(std::vector<Part>& parts) override;

 private:
  const FileDescriptor file_;
  const uint64_t size_;
  uint64_t sent_ = 0;
  RareLog failed_{std::chrono::seconds(10)};
};

}  // namespace tessera
