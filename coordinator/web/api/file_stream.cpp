#include "coordinator/web/api/file_stream.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr uint64_t kPieceBytes = 256 << 10;

}  // namespace

Result<std::shared_ptr<FileStream>> FileStream::Make(const std::string& folder, std::string_view bytes) {
  auto file = OpenNamelessFile(folder);
  if (!file) return file.error();
  if (!WriteAll(file->number(), bytes))
    return Failed(fmt::format("no room for a copy of the picture: {}", std::strerror(errno)));
  return std::make_shared<FileStream>(std::move(*file), bytes.size());
}

// A file that cannot be read ends the download early, which the reader sees by its size. The pieces were
// written a moment ago, so the thread of the server seldom waits for the disk.
FileStream::Next FileStream::Take(std::vector<Part>& parts) {
  if (sent_ == size_) return Next::kEnd;
  auto piece = std::make_shared<std::string>(std::min(kPieceBytes, size_ - sent_), '\0');
  ssize_t size = 0;
  do {
    size = ::pread(file_.number(), piece->data(), piece->size(), static_cast<off_t>(sent_));
  } while (size < 0 && errno == EINTR);
  if (size <= 0) {
    const std::string reason = size < 0 ? std::strerror(errno) : "it was cut";
    failed_.Warn("web_download_cut",
                 fmt::format("sent={} bytes={} reason={}", sent_, size_, LogText(reason)));
    return Next::kEnd;
  }
  piece->resize(static_cast<size_t>(size));
  sent_ += static_cast<uint64_t>(size);
  parts.push_back(std::move(piece));
  return Next::kParts;
}

}  // namespace tessera
