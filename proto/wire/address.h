// An address to listen on or connect to: HOST:PORT or unix:PATH. Independent of gRPC.
#pragma once

#include <string>

#include "renderer/util/result.h"

namespace tessera {

struct Address {
  enum class Kind { kTcp, kUnix };
  Kind kind = Kind::kTcp;
  std::string host;  // kTcp: a name or number; an IPv6 number without brackets
  int port = 0;      // kTcp; 0 to listen on any free port
  std::string path;  // kUnix

  bool operator==(const Address&) const = default;
  std::string Text() const;    // as a user writes it
  std::string Target() const;  // as gRPC takes it
  // Whether only this machine can reach it: a Unix socket, 127.x.x.x, ::1 or localhost.
  bool IsLocal() const;
};

// Parses `HOST:PORT`, `[IPV6]:PORT` or `unix:PATH`. `what` names the option in the error.
Result<Address> ParseAddress(const std::string& text, const std::string& what);

}  // namespace tessera
