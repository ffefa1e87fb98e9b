#include "client/doctor/listening_sockets.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace tessera {
namespace {

constexpr const char* kListening = "0A";  // TCP_LISTEN
constexpr size_t kDigitsOfWord = 8;

// The numbers of the sockets that a process has open.
std::set<std::string> SocketsOf(const std::string& process) {
  constexpr std::string_view kPrefix = "socket:[";
  std::set<std::string> numbers;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(process + "/fd", error)) {
    std::error_code gone;
    const std::string target = std::filesystem::read_symlink(entry.path(), gone);
    if (!gone && target.starts_with(kPrefix))
      numbers.insert(target.substr(kPrefix.size(), target.size() - kPrefix.size() - 1));
  }
  return numbers;
}

}  // namespace

// Each 32-bit word is printed as the machine reads its bytes.
std::optional<Address> ParseKernelAddress(const std::string& text) {
  const size_t colon = text.find(':');
  if (colon != kDigitsOfWord && colon != 4 * kDigitsOfWord) return std::nullopt;
  uint32_t words[4] = {};
  for (size_t i = 0; i < colon / kDigitsOfWord; ++i) {
    const char* const begin = text.data() + i * kDigitsOfWord;
    const auto [end, bad] = std::from_chars(begin, begin + kDigitsOfWord, words[i], 16);
    if (bad != std::errc() || end != begin + kDigitsOfWord) return std::nullopt;
  }
  Address address;
  const char* const begin = text.data() + colon + 1;
  const auto [end, bad] = std::from_chars(begin, text.data() + text.size(), address.port, 16);
  if (bad != std::errc() || end != text.data() + text.size() || end == begin) return std::nullopt;
  char host[INET6_ADDRSTRLEN] = "";
  ::inet_ntop(colon == kDigitsOfWord ? AF_INET : AF_INET6, words, host, sizeof host);
  address.host = host;
  return address;
}

std::vector<Address> ListeningAddresses(pid_t process) {
  const std::string folder = fmt::format("/proc/{}", process);
  const std::set<std::string> sockets = SocketsOf(folder);
  std::vector<Address> found;
  for (const char* table : {"/net/tcp", "/net/tcp6"}) {
    std::ifstream file(folder + table);
    std::string line;
    std::getline(file, line);  // the headings
    while (std::getline(file, line)) {
      std::istringstream fields(line);
      std::string number, local, remote, state, skipped, socket;
      fields >> number >> local >> remote >> state >> skipped >> skipped >> skipped >> skipped >> skipped >>
          socket;
      if (state != kListening || !sockets.contains(socket)) continue;
      if (auto address = ParseKernelAddress(local)) found.push_back(std::move(*address));
    }
  }
  return found;
}

}  // namespace tessera
