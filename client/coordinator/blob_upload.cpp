// CoordinatorClient::Upload: the files of a scene, each as a blob, then the manifest that lists them.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <map>
#include <vector>

#include "client/coordinator/coordinator_connection.h"
#include "proto/wire/convert.h"
#include "renderer/util/threads.h"

namespace tessera {
namespace {

// A file on disk or bytes in memory to be sent.
struct Source {
  Digest digest;
  uint64_t size = 0;
  std::string path;  // of the file; empty: `bytes`
  std::string_view bytes;
  bool is_manifest = false;
};

// Reads a source piece by piece.
class SourceReader {
 public:
  SourceReader(const Source& source, uint64_t offset)
      : source_(source),
        offset_(offset),
        // Not blocking: a pipe may have taken the file's place.
        fd_(source.path.empty() ? -1 : ::open(source.path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~SourceReader() {
    if (fd_ >= 0) ::close(fd_);
  }
  SourceReader(const SourceReader&) = delete;
  SourceReader& operator=(const SourceReader&) = delete;

  // Reads the next piece, which is empty at the end. Returns false if the file cannot be read.
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
  uint64_t offset_;
  int fd_;
};

// Sends the bytes from `offset` on and adds their number to `bytes_sent`.
grpc::Status SendBlob(proto::Blobs::Stub& stub, grpc::ClientContext* context, const Source& source,
                      uint64_t offset, std::atomic<uint64_t>& bytes_sent) {
  SourceReader reader(source, offset);
  proto::UploadAnswer answer;
  const auto writer = stub.Upload(context, &answer);
  proto::UploadChunk chunk;
  chunk.set_digest(WriteDigest(source.digest));
  chunk.set_size(source.size);
  chunk.set_offset(offset);
  bool is_first = true;
  do {
    if (!reader.Next(*chunk.mutable_data())) {
      context->TryCancel();
      writer->Finish();
      return {grpc::StatusCode::FAILED_PRECONDITION, fmt::format("{} can no longer be read", source.path)};
    }
    const bool is_last = chunk.data().empty() && !is_first;
    // A write is refused if the coordinator already has the blob, or on an error that Finish returns.
    if (is_last || !writer->Write(chunk)) break;
    bytes_sent += chunk.data().size();
    is_first = false;
    chunk.clear_digest();
    chunk.clear_size();
    chunk.clear_offset();
  } while (!chunk.data().empty());
  writer->WritesDone();
  return writer->Finish();
}

// The digests of the blobs that the coordinator lacks, each with the number of bytes that it has already.
using Missing = std::map<std::string, uint64_t>;

// Sends blobs over several streams in parallel, so that small files do not wait for each other's answers and
// no file waits for a large one.
template <typename Connection>
class Uploader {
 public:
  Uploader(const Connection& connection, const CoordinatorClient::OnSlow& on_slow)
      : connection_(connection), on_slow_(on_slow), stub_(*connection.blobs), stop_(connection.stop) {}

  Result<Missing> FindMissing(const std::vector<std::string>& digests) {
    proto::FindMissingRequest request;
    for (const std::string& digest : digests) request.add_digests(digest);
    proto::FindMissingAnswer answer;
    auto asked = WithRetries(connection_, "ask for missing files", [&] {
      CallContext context(stop_, connection_.farm, kCallPatience);
      return stub_.FindMissing(context.get(), request, &answer);
    });
    if (!asked) return asked.error();
    Missing missing;
    for (int i = 0; i < answer.missing_size(); ++i)
      missing[answer.missing(i)] = i < answer.held_size() ? answer.held(i) : 0;
    return missing;
  }
  // Sends all of them. Returns the first error.
  Result<void> Send(std::vector<std::pair<const Source*, uint64_t>> queue) {
    queue_ = std::move(queue);
    const std::stop_callback on_stop(stop_, [this] { broken_.request_stop(); });
    ThreadGroup threads([this](Error why) { Fail(std::move(why)); });
    const size_t count = std::min(kParallelUploads, queue_.size());
    // With fewer threads it takes longer.
    for (size_t i = 1; i < count && threads.Start([this] { SendNext(); }); ++i) {
    }
    SendNext();
    threads.Join();
    if (error_) return *error_;
    return {};
  }
  uint64_t bytes_sent() const { return bytes_sent_; }

 private:
  static constexpr size_t kParallelUploads = 4;

  void SendNext() {
    for (size_t next = taken_++; next < queue_.size() && !broken_.stop_requested(); next = taken_++) {
      const auto sent = SendOne(*queue_[next].first, queue_[next].second);
      if (!sent) Fail(sent.error());
    }
  }
  void Fail(Error why) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::move(why);
    broken_.request_stop();
  }
  void ReportSlow(const std::string& what, const grpc::Status& status) {
    const std::lock_guard lock(mutex_);
    if (on_slow_ && !std::exchange(is_reported_, true))
      on_slow_(fmt::format("waiting to {}: {}", what, CleanReason(status.error_message())));
  }
  // An interrupted upload continues where it stopped, as long as some bytes get through in time.
  Result<void> SendOne(const Source& source, uint64_t held) {
    const std::string what = source.is_manifest    ? "send the list of files"
                             : source.path.empty() ? "send the scene from standard input"
                                                   : "send " + source.path;
    Retries retries(connection_.channel, broken_.get_token(), connection_.patience);
    while (true) {
      CallContext context(broken_.get_token(), connection_.farm);
      const grpc::Status status =
          SendBlob(stub_, context.get(), source, std::min(held, source.size), bytes_sent_);
      if (status.ok()) return {};
      if (!retries.Again(status)) return connection_.ErrorOf(status, what);
      ReportSlow(what, status);
      const auto missing = FindMissing({WriteDigest(source.digest)});
      if (!missing) return missing.error();
      if (missing->empty()) return {};
      if (missing->begin()->second > held) retries.Progress();
      held = missing->begin()->second;
    }
  }

  const Connection& connection_;
  const CoordinatorClient::OnSlow& on_slow_;
  proto::Blobs::Stub& stub_;
  std::stop_token stop_;
  std::stop_source broken_;  // ends the other streams when one fails
  std::vector<std::pair<const Source*, uint64_t>> queue_;
  std::atomic<size_t> taken_{0};
  std::atomic<uint64_t> bytes_sent_{0};
  std::mutex mutex_;
  std::optional<Error> error_;  // guarded by mutex_
  bool is_reported_ = false;    // guarded by mutex_
};

}  // namespace

Result<UploadReport> CoordinatorClient::Upload(const PackedScene& scene, const OnSlow& on_slow) {
  std::map<std::string, Source> sources;  // by digest as it travels
  for (const auto& [path, file] : scene.package.files) {
    Source& source = sources[WriteDigest(file.digest)];
    source = {file.digest, file.size, {}, {}};
    const auto in_memory = scene.in_memory.find(file.digest);
    if (in_memory != scene.in_memory.end()) {
      source.bytes = *in_memory->second;
    } else {
      source.path = scene.disk_paths.at(file.digest);
    }
  }
  UploadReport report;
  report.files_total = sources.size();
  sources[WriteDigest(scene.digest)] = {scene.digest, scene.manifest.size(), {}, scene.manifest, true};
  Uploader uploader(*connection_, on_slow);
  std::vector<std::pair<const Source*, uint64_t>> queue;
  for (auto it = sources.begin(); it != sources.end();) {
    std::vector<std::string> digests;
    for (; it != sources.end() && digests.size() < size_t{kDigestsPerCallMax}; ++it)
      digests.push_back(it->first);
    const auto missing = uploader.FindMissing(digests);
    if (!missing) return missing.error();
    for (const auto& [digest, held] : *missing) {
      const auto source = sources.find(digest);
      if (source == sources.end())
        return Failed("the coordinator asked for a file that is not part of this scene");
      queue.emplace_back(&source->second, held);
      report.files_sent += source->second.is_manifest ? 0 : 1;
    }
  }
  if (auto sent = uploader.Send(std::move(queue)); !sent) return sent.error();
  report.bytes_sent = uploader.bytes_sent();
  return report;
}

}  // namespace tessera
