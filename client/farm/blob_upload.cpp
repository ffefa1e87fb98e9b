// CoordinatorClient::Upload: the files of a scene, each as a blob, then the manifest that lists them.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "farm/coordinator_connection.h"
#include "wire/convert.h"

namespace tessera {
namespace {

// Bytes to send: a file on disk, or bytes in memory.
struct Source {
  Digest digest;
  uint64_t size = 0;
  std::string path;  // empty: `bytes`
  std::string_view bytes;
};

// Gives the source piece by piece.
class SourceReader {
 public:
  explicit SourceReader(const Source& source)
      : source_(source), fd_(source.path.empty() ? -1 : ::open(source.path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~SourceReader() {
    if (fd_ >= 0) ::close(fd_);
  }
  SourceReader(const SourceReader&) = delete;
  SourceReader& operator=(const SourceReader&) = delete;

  // Fills `piece`; empty at the end. False if the file cannot be read.
  bool Next(std::string& piece) {
    const uint64_t left = source_.size - offset_;
    piece.resize(std::min<uint64_t>(left, kChunkBytesMax));
    if (source_.path.empty()) {
      piece = source_.bytes.substr(offset_, piece.size());
    } else if (!piece.empty()) {
      ssize_t got = 0;
      do {
        got = ::pread(fd_, piece.data(), piece.size(), static_cast<off_t>(offset_));
      } while (got < 0 && errno == EINTR);
      if (got <= 0) return false;
      piece.resize(static_cast<size_t>(got));
    }
    offset_ += piece.size();
    return true;
  }

 private:
  const Source& source_;
  int fd_;
  uint64_t offset_ = 0;
};

grpc::Status SendBlob(proto::Blobs::Stub& stub, grpc::ClientContext* context, const Source& source) {
  SourceReader reader(source);
  proto::UploadAnswer answer;
  const auto writer = stub.Upload(context, &answer);
  proto::UploadChunk chunk;
  chunk.set_digest(WriteDigest(source.digest));
  chunk.set_size(source.size);
  do {
    if (!reader.Next(*chunk.mutable_data())) {
      context->TryCancel();
      writer->Finish();
      return {grpc::StatusCode::FAILED_PRECONDITION, fmt::format("{} cannot be read any more", source.path)};
    }
    const bool is_last = chunk.data().empty() && source.size > 0;
    if (is_last || !writer->Write(chunk))
      break;  // a refused write: the coordinator has it already, or an error
    chunk.clear_digest();
    chunk.clear_size();
  } while (!chunk.data().empty());
  writer->WritesDone();
  return writer->Finish();
}

}  // namespace

Result<void> CoordinatorClient::Upload(const PackedScene& scene) {
  std::map<std::string, Source> sources;  // by digest as it travels
  for (const auto& [path, file] : scene.package.files) {
    sources[WriteDigest(file.digest)] = {file.digest, file.size, scene.disk_paths.at(file.digest), {}};
  }
  sources[WriteDigest(scene.digest)] = {scene.digest, scene.manifest.size(), {}, scene.manifest};
  const std::stop_token stop = connection_->stop;
  for (auto it = sources.begin(); it != sources.end();) {
    proto::FindMissingRequest request;
    for (; it != sources.end() && request.digests_size() < kDigestsPerCallMax; ++it)
      request.add_digests(it->first);
    proto::FindMissingAnswer answer;
    auto asked = WithRetries(stop, "ask for missing files", [&] {
      CallContext context(stop, kCallPatience);
      return connection_->blobs->FindMissing(context.get(), request, &answer);
    });
    if (!asked) return asked;
    for (const std::string& digest : answer.missing()) {
      const auto source = sources.find(digest);
      if (source == sources.end()) return Failed("the coordinator asks for a file that is not of this scene");
      const std::string& path = source->second.path;
      auto sent = WithRetries(stop, fmt::format("send {}", path.empty() ? "the list of files" : path), [&] {
        CallContext context(stop);
        return SendBlob(*connection_->blobs, context.get(), source->second);
      });
      if (!sent) return sent;
    }
  }
  return {};
}

}  // namespace tessera
