// How a program reaches a coordinator: the address that the user named, and what is used to connect to it.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "proto/identity/login.h"
#include "proto/identity/tls_files.h"
#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace tessera {

struct Endpoint {
  Address address;  // as the user named it, for messages
  Address target;   // to connect to: the same, or the local socket of the address
  // For TLS, one of these; without them the connection is plain.
  std::optional<Login> login;
  std::optional<TlsFiles> organisation;

  // An address to which connections are plain.
  Endpoint(const Address& plain) : address(plain), target(plain) {}
  Endpoint(Address named, Address connected, std::optional<Login> of)
      : address(std::move(named)), target(std::move(connected)), login(std::move(of)) {}
  // With certificates of an organisation.
  Endpoint(const Address& encrypted, TlsFiles files)
      : address(encrypted), target(encrypted), organisation(std::move(files)) {}
  bool IsLocalSocket() const { return target.kind == Address::Kind::kUnix && target != address; }
};

// With a login. Fails if its files are damaged, can be read by others or have expired.
Result<Endpoint> EndpointOf(const Login& login);

struct EndpointRules {
  // Whether plain text on a TCP address of this machine is wanted.
  bool insecure = false;
  LoginStore logins;
  std::string socket_folder;  // LocalSocketFolder
  // What to do if there is no login for an address: "run: tessera login TOKEN".
  std::string advice;
  // Certificates of an organisation, if wanted: then all of its files are.
  TlsFiles organisation = {};
  // For what an operator does: the local socket, if a coordinator listens there, goes before a login, which
  // may be one with another role.
  bool prefer_local_socket = false;
};

// Chooses, in this order: a Unix socket as it is; plain text if `insecure`, for addresses of this machine
// alone; certificates of an organisation, which are checked; the local socket if it is preferred; the login
// for this address; the local socket of an address of this machine. An error that says how to get a login if
// there is none of them.
Result<Endpoint> ChooseEndpoint(const Address& address, const EndpointRules& rules);

}  // namespace tessera
