#include "client/doctor/coordinator_checks.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>

#include "client/doctor/file_checks.h"
#include "client/doctor/listening_sockets.h"
#include "client/doctor/login_checks.h"
#include "proto/identity/private_file.h"
#include "proto/shell/program.h"
#include "proto/wire/address.h"
#include "proto/wire/local_socket.h"
#include "proto/wire/reachability.h"

namespace tessera {
namespace {

// The kernel keeps the first 15 characters of a program's name.
constexpr const char* kCoordinatorProgram = "tessera-coordin";

std::string FirstLineOf(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

// The word after `flag`, or in `flag`=WORD, of a command line.
std::string WordAfter(const std::vector<std::string>& words, const std::string& flag) {
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == flag && i + 1 < words.size()) return words[i + 1];
    if (words[i].starts_with(flag + "=")) return words[i].substr(flag.size() + 1);
  }
  return {};
}

std::vector<std::string> CommandLineOf(const std::string& process) {
  std::ifstream file(process + "/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
  return words;
}

// Whether the process has the same namespace of this kind as this one, and may be examined.
bool SharesNamespace(const std::string& process, const char* kind) {
  std::error_code error, own_error;
  const auto theirs = std::filesystem::read_symlink(process + "/ns/" + kind, error);
  const auto ours = std::filesystem::read_symlink(std::string("/proc/self/ns/") + kind, own_error);
  return !error && !own_error && theirs == ours;
}

std::string DataDirOf(const std::string& process) {
  const std::string folder = WordAfter(CommandLineOf(process), "--data-dir");
  if (folder.empty() || folder.starts_with('/')) return folder;
  std::error_code error;
  const auto current = std::filesystem::read_symlink(process + "/cwd", error);
  return error ? folder : (current / folder).string();
}

// What answers on an address: the farm or its web page, with TLS or in plain text.
Finding CheckAddress(const std::string& where, const Address& address) {
  Address nearby = address;
  if (address.host == "0.0.0.0") nearby.host = "127.0.0.1";
  if (address.host == "::") nearby.host = "::1";
  const bool is_encrypted = FetchCertificates(nearby).has_value();
  const bool is_page = IsWebServer(nearby, is_encrypted);
  const std::string what = fmt::format("{}, {}, is open to {}", address.Text(),
                                       is_page ? "the web page" : "for workers and commands",
                                       address.IsLocal() ? "only this machine" : "other machines");
  if (is_encrypted) {
    const char* const to = is_page ? "holders of certificates and people who log in with a token"
                                   : "holders of certificates and tokens";
    return {Severity::kGood, where, fmt::format("{}, encrypted, to {}", what, to), {}};
  }
  if (address.IsLocal() && is_page) {
    return {Severity::kGood,
            where,
            what + ", in plain text; its other users may look at jobs and workers there",
            {}};
  }
  if (address.IsLocal()) {
    return {Severity::kWarning, where, what + ", but to all of its users, in plain text",
            "leave --insecure out, or do not share this machine"};
  }
  return {Severity::kProblem, where, what + " in plain text, without a login",
          "stop that: use an address of this machine alone, such as 127.0.0.1"};
}

void CheckCertificateFile(const std::string& where, const std::string& what, const std::string& path,
                          const std::string& renewal, Findings& findings) {
  if (!std::filesystem::exists(path)) return;
  const auto pem = ReadPrivateFile(path);
  const auto certificate = pem ? Certificate::FromPem(*pem, path) : Result<Certificate>(pem.error());
  if (certificate) {
    findings.push_back(CheckTimes(where, what, *certificate, UnixNow(), renewal));
  } else if (pem) {  // otherwise the mode is the reason, which is a finding already
    findings.push_back({Severity::kProblem, where, certificate.error().message, "restore it from a backup"});
  }
}

}  // namespace

std::vector<RunningCoordinator> FindCoordinators() {
  std::vector<RunningCoordinator> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
    const std::string name = entry.path().filename();
    pid_t pid = 0;
    const auto [end, bad] = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (bad != std::errc() || *end != '\0') continue;
    if (FirstLineOf(entry.path().string() + "/comm") != kCoordinatorProgram) continue;
    // Of another user, or in a container, where addresses and paths mean something else.
    if (!SharesNamespace(entry.path().string(), "net") || !SharesNamespace(entry.path().string(), "mnt"))
      continue;
    found.push_back({pid, DataDirOf(entry.path().string())});
  }
  std::ranges::sort(found, {}, &RunningCoordinator::pid);
  return found;
}

bool IsRunning(const RunningCoordinator& coordinator) {
  return FirstLineOf(fmt::format("/proc/{}/comm", coordinator.pid)) == kCoordinatorProgram;
}

Findings CheckDataDirectory(const std::string& folder) {
  const std::string where = fmt::format("data directory {}", folder);
  if (!std::filesystem::is_directory(folder))
    return {{Severity::kProblem, where, "there is no such folder", "check --data-dir"}};
  Findings findings = CheckPrivacy(where, folder);
  const std::string identity = folder + "/identity";
  if (std::filesystem::exists(identity)) Append(findings, CheckPrivacy(where, identity));
  CheckCertificateFile(where, "the farm's authority", identity + "/authority.pem",
                       "move the folder identity away and restart; all members have to join again", findings);
  CheckCertificateFile(where, "the certificate of the coordinator", identity + "/coordinator.pem",
                       "restart the coordinator", findings);
  CheckCertificateFile(where, "the certificate of the organisation", identity + "/shown.pem",
                       "get a new one, and put it where --tls-cert names it", findings);
  findings.push_back(CheckSpace(where, folder));
  return findings;
}

Findings CheckListening(const RunningCoordinator& coordinator, std::stop_token stop) {
  const std::string socket_folder = LocalSocketFolder(Environment);
  const std::string where = fmt::format("coordinator (process {})", coordinator.pid);
  Findings findings;
  for (const Address& address : ListeningAddresses(coordinator.pid)) {
    findings.push_back(CheckAddress(where, address));
    const auto socket = LocalSocketOf(address, socket_folder);
    if (socket && std::filesystem::exists(socket->path))
      Append(findings, CheckCoordinatorAt(where, Endpoint(address, *socket, std::nullopt), stop));
  }
  return findings;
}

}  // namespace tessera
