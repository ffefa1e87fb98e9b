// A coordinator: everything between its options and its end.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "coordinator/access.h"
#include "coordinator/options.h"
#include "proto/wire/address.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

class BlobStore;
class ResultsIntake;

// Serves from Start to Stop. Thread safe.
class Coordinator {
 public:
  // Opens the data directory, recovers what a former process left and listens. The error states what is
  // wrong with the directory or which address cannot be listened on.
  static Result<std::unique_ptr<Coordinator>> Start(const CoordinatorOptions& options,
                                                    AccessPolicy policy = AdmitByRole);
  ~Coordinator();
  Coordinator(const Coordinator&) = delete;
  Coordinator& operator=(const Coordinator&) = delete;

  // Where it listens, with the ports that were chosen for port 0.
  const std::vector<Address>& addresses() const;
  // Of the farm's authority; nullopt if the coordinator only has plain connections.
  std::optional<Digest> authority_fingerprint() const;
  // Of the web page, plain and encrypted, if there is one.
  std::optional<Address> http() const;
  std::optional<Address> https() const;
  const BlobStore& blobs() const;
  const ResultsIntake& intake() const;
  // Encrypted connections whose other end has not shown that it belongs to the farm.
  size_t pending_connections() const;
  // Clients that watch jobs.
  size_t watcher_count() const;

  // Answers the calls that wait, takes no new ones and ends all threads. Everything acknowledged is on disk.
  void Stop();

 private:
  struct Parts;
  explicit Coordinator(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace tessera
