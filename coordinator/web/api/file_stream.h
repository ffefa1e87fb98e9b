// Sends a file: it takes no memory while a slow reader takes it.
#pragma once

#include <chrono>
#include <utility>
#include <vector>

#include "coordinator/web/http_response.h"
#include "proto/shell/rare_log.h"
#include "renderer/util/readable_file.h"

namespace tessera {

class FileStream final : public BodyStream {
 public:
  explicit FileStream(ReadableFile file) : file_(std::move(file)) {}

  Next Take(std::vector<Part>& parts) override;

 private:
  const ReadableFile file_;
  uint64_t sent_ = 0;
  RareLog failed_{std::chrono::seconds(10)};
};

}  // namespace tessera
