// What the web pages ask the farm about people.
#pragma once

#include <functional>
#include <string>

#include "proto/identity/certificate.h"
#include "proto/membership.h"
#include "renderer/util/result.h"

namespace tessera {

// A member who may look at the pages.
struct Visitor {
  MemberId member{};
  std::string name, role;
};

// The errors are for the person. Thread safe.
struct WebGate {
  // The holder of a certificate that was admitted in the handshake.
  std::function<Result<Visitor>(const Certificate& certificate)> identify;
  // A member who has identified before: an error if that was revoked or has expired.
  std::function<Result<Visitor>(MemberId member)> recheck;
  // Makes the holder of the token with this key a member for kSessionLifetime. Counts as a use of the token,
  // except if it gives no right to look at the pages. May wait for the disk for a moment.
  std::function<Result<Visitor>(const Digest& token_key, const std::string& peer)> join;
  // Ends the membership that `join` has made.
  std::function<void(MemberId member, const std::string& peer)> leave;
};

}  // namespace tessera
