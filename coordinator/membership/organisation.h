// The certificates of an organisation, used by a coordinator in place of its own or beside them: its server
// certificate, and the authorities whose certificates make their holders members.
//
// A coordinator shows one file: the key, the certificate of the organisation and those that issued it, then a
// certificate of the farm's own authority for the same key (server_check.h). So browsers and programs of the
// organisation accept it, and so does whoever joined with a token. The file is written whenever the files of
// the organisation change, and only if key and certificate belong together.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "proto/identity/authority.h"
#include "proto/identity/tls_files.h"
#include "renderer/util/result.h"

namespace tessera {

// Thread safe.
class Organisation {
 public:
  // Reads the files and writes `served_path`. Fails if they cannot be used.
  static Result<std::shared_ptr<Organisation>> Open(TlsFiles files, const Authority& farm,
                                                    std::string served_path, UnixTime now);

  // Reads the files again if they have changed, and writes a new certificate of the farm in time. Returns
  // whether anything changed. On an error, everything stays as it was.
  Result<bool> Refresh(UnixTime now);
  // Of the certificates of members; empty if they have to join with tokens.
  std::vector<Certificate> authorities() const;

 private:
  Organisation(TlsFiles files, const Authority& farm, std::string served_path)
      : files_(std::move(files)), farm_(farm), served_path_(std::move(served_path)) {}

  const TlsFiles files_;
  const Authority farm_;
  const std::string served_path_;
  std::string bytes_read_;    // of all files; belongs to whoever calls Refresh
  UnixTime renewal_due_ = 0;  // as above
  mutable std::mutex mutex_;
  std::vector<Certificate> authorities_;  // guarded by mutex_
};

}  // namespace tessera
