// The logins of a person or a worker: one folder per farm, named by its user.
//   address         HOST:PORT of the coordinator
//   authority.pem   certificates that the coordinator's certificate must be issued by
//   identity.pem    private key and certificate of this member, mode 0600
// A renewed identity replaces identity.pem as a whole, so key and certificate always belong together.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "proto/identity/certificate.h"
#include "proto/identity/private_key.h"

namespace tessera {

struct Login {
  std::string farm;  // its name here
  std::string folder;
  std::string address;

  std::string AddressPath() const { return folder + "/address"; }
  std::string AuthorityPath() const { return folder + "/authority.pem"; }
  std::string IdentityPath() const { return folder + "/identity.pem"; }
};

// What a coordinator has issued.
struct IssuedIdentity {
  PrivateKey key;
  std::string certificate_pem;
  std::string authority_pem;
};

class LoginStore {
 public:
  explicit LoginStore(std::string folder) : folder_(std::move(folder)) {}
  const std::string& folder() const { return folder_; }

  // Keeps an identity as the login `farm`, in place of an earlier one of that name. `farm` is the default
  // from now on.
  Result<Login> Save(const std::string& farm, const std::string& address,
                     const IssuedIdentity& identity) const;
  // Deletes the key and the certificates of a login, the key first. If it was the default, there is none
  // until the next Save. Other files in its folder stay.
  Result<void> Remove(const Login& login) const;
  // In the order of their names. Folders that cannot be read are left out.
  std::vector<Login> List() const;
  std::optional<Login> Find(const std::string& farm) const;
  // The default if it has this address, or else any login with it.
  std::optional<Login> FindAddress(const std::string& address) const;
  // The last login that was saved, unless it was removed.
  std::optional<Login> Default() const;

 private:
  std::string folder_;
};

// Reads the certificate of a login. Fails if its files are missing, damaged or can be read by others.
Result<Certificate> ReadIdentity(const Login& login);

// Whether a farm may have this name here: letters, digits and ". _ -", at most 64, not beginning with a dot.
bool IsFarmName(const std::string& name);
// A name after an address: "10.0.0.5-7700".
std::string FarmNameFor(std::string address);

using ReadVariable = std::function<std::string(const char* variable)>;
// Where people keep logins: $XDG_CONFIG_HOME/tessera/farms or ~/.config/tessera/farms.
std::string PersonalLoginFolder(const ReadVariable& environment);
// Where workers keep logins: farms in systemd's $STATE_DIRECTORY, in $XDG_STATE_HOME/tessera/worker or in
// ~/.local/state/tessera/worker.
std::string WorkerLoginFolder(const ReadVariable& environment);

}  // namespace tessera
