#include "client/doctor/login_checks.h"

#include <fmt/format.h>

#include <filesystem>

#include "client/coordinator/coordinator_facts.h"
#include "client/doctor/facts_findings.h"
#include "client/doctor/file_checks.h"
#include "proto/identity/private_key.h"
#include "proto/wire/reachability.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

std::string RemedyFor(Obstacle obstacle, const Address& address) {
  switch (obstacle) {
    case Obstacle::kName:
      return fmt::format(
          "check the address; \"getent hosts {}\" has to print one: see /etc/hosts and the name server",
          address.host);
    case Obstacle::kRefused:
      return fmt::format(
          "start tessera-coordinator there, or check that its --listen has port {} and an address that "
          "other machines reach (0.0.0.0)",
          address.port);
    case Obstacle::kTimeout:
      return fmt::format(
          "a firewall drops the packets, or the machine is off: allow TCP port {} there and on the way "
          "(for example: ufw allow {}/tcp)",
          address.port, address.port);
    case Obstacle::kNoRoute: return "check the network of this machine: addresses, routes, VPN";
    case Obstacle::kOtherProgram: return "check host and port: another program listens there";
    case Obstacle::kOtherFarm: return "ask an operator of the farm for a token and join again";
    case Obstacle::kNotAdmitted:
      return "ask an operator of the farm (tessera access lists members) for a token and join again";
    case Obstacle::kNone:
    case Obstacle::kOther: break;
  }
  return "see client/guide/farm.md, \"A farm of several machines\"";
}

Findings CheckFiles(const std::string& where, const Login& login, UnixTime now) {
  Findings findings = CheckPrivacy(where, login.folder);
  const auto identity = ReadIdentity(login);
  if (identity) {
    findings.push_back(
        CheckTimes(where, "the certificate", *identity, now,
                   identity->NotAfter() > now
                       ? "it is renewed by every command or running worker that reaches the coordinator"
                       : "ask an operator of the farm for a token and join again"));
  } else if (findings.empty()) {
    findings.push_back({Severity::kProblem, where, identity.error().message, "join again with a new token"});
  }
  const auto pem = ReadFile(login.AuthorityPath(), kPemBytesMax);
  const auto authority =
      pem ? Certificate::FromPem(*pem, login.AuthorityPath()) : Result<Certificate>(pem.error());
  if (!authority) {
    findings.push_back({Severity::kProblem, where, authority.error().message, "join again with a new token"});
  } else if (Finding times = CheckTimes(where, "the farm's authority", *authority, now,
                                        "the operator has to make a new one, and all members join again");
             times.severity != Severity::kGood) {
    findings.push_back(std::move(times));
  }
  return findings;
}

}  // namespace

Findings CheckCoordinatorAt(const std::string& where, const Endpoint& endpoint, std::stop_token stop) {
  const Reachability found = CheckReachability(endpoint, stop);
  if (!found.speaks_http2)
    return {{Severity::kProblem, where, found.reason, RemedyFor(found.obstacle, endpoint.address)}};
  const auto facts = AskForFacts(endpoint, stop);
  if (!facts)
    return {{Severity::kProblem, where, facts.error().message,
             RemedyFor(Obstacle::kNotAdmitted, endpoint.address)}};
  return FindingsOf(where, *facts);
}

Findings CheckLogins(const LoginStore& logins, const std::string& kind, std::stop_token stop) {
  Findings findings;
  for (const Login& login : logins.List()) {
    const std::string where = fmt::format("{} \"{}\" ({})", kind, login.farm, login.address);
    Append(findings, CheckFiles(where, login, UnixNow()));
    const auto address = ParseAddress(login.address, login.folder);
    if (!address) {
      findings.push_back({Severity::kProblem, where, address.error().message, "join again with a new token"});
      continue;
    }
    Append(findings, CheckCoordinatorAt(where, Endpoint(*address, *address, login), stop));
  }
  return findings;
}

}  // namespace tessera
