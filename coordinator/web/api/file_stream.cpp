#include "coordinator/web/api/file_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr uint64_t kPieceBytes = 256 << 10;

}  // namespace

// A file that cannot be read ends the download early, which the reader sees by its size. The bytes were read
// or written a moment ago, so the thread of the server seldom waits for the disk.
FileStream::Next FileStream::Take(std::vector<Part>& parts) {
  if (sent_ == file_.size()) return Next::kEnd;
  auto piece = std::make_shared<std::string>(std::min(kPieceBytes, file_.size() - sent_), '\0');
  const auto read = file_.Read(sent_, *piece);
  if (!read || piece->empty()) {
    const std::string reason = read ? "it was cut" : read.error().message;
    failed_.Warn("web_download_cut",
                 fmt::format("sent={} bytes={} reason={}", sent_, file_.size(), LogText(reason)));
    return Next::kEnd;
  }
  sent_ += piece->size();
  parts.push_back(std::move(piece));
  return Next::kParts;
}

}  // namespace tessera
