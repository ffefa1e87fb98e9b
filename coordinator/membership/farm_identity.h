// The keys and certificates of a coordinator, in a folder of its data directory that only its user may read.
//   authority.pem     key and certificate of the farm's private certificate authority; made once
//   coordinator.pem   key and certificate of this coordinator, and the certificate of the authority
//   shown.pem         with a certificate of an organisation: what is shown instead (organisation.h)
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "proto/identity/authority.h"
#include "renderer/util/result.h"

namespace tessera {

// A coordinator's certificate is made again when less than half of this is left.
constexpr std::chrono::hours kCoordinatorLifetime{24 * 365};

// What a farm knows of its authority: that members have certificates of it, and its fingerprint.
struct ExpectedAuthority {
  bool has_members = false;
  std::optional<Digest> fingerprint;  // if it is known
};

class FarmIdentity {
 public:
  // Reads the folder and makes what is missing. The coordinator's certificate is also made again if it is not
  // for `host_names`, has less than half of its life left or is not of this authority. Fails and leaves the
  // folder as it is if its authority is missing or is not that of `expected`.
  static Result<FarmIdentity> Open(const std::string& folder, std::vector<std::string> host_names,
                                   UnixTime now, const ExpectedAuthority& expected = {});

  // Whether the folder has an authority.
  static bool Exists(const std::string& folder);

  const Authority& authority() const { return authority_; }
  // The file that the coordinator shows: key and certificates.
  const std::string& coordinator_path() const { return coordinator_path_; }
  void ShowOther(std::string path) { coordinator_path_ = std::move(path); }
  // Whether there was no authority before.
  bool is_new() const { return is_new_; }

 private:
  FarmIdentity(Authority authority, std::string coordinator_path, bool is_new)
      : authority_(std::move(authority)), coordinator_path_(std::move(coordinator_path)), is_new_(is_new) {}
  Authority authority_;
  std::string coordinator_path_;
  bool is_new_;
};

// The name of this machine and the addresses of its interfaces, without those that only this machine can
// reach.
std::vector<std::string> NamesOfThisMachine();

}  // namespace tessera
